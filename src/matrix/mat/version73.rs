//! Variables of MAT-files of version 7.3 (`save -v7.3`).
//!
//! An HDF5 file behind 512 bytes that begin with `MATLAB 7.3`. A variable is a member of the root
//! group whose attribute `MATLAB_class` names its class. An array has its indices in reverse order:
//! HDF5's last index runs fastest, MATLAB's first. Complex numbers are compounds; sparse matrices,
//! structs and some others are groups; cells are arrays of references.

use super::super::array::{Array, ArrayError, Number, damaged, from_fortran, unsupported};
use super::choice::{Choice, entries};
use super::hdf5::{Attribute, Dataset, Datatype, Fault, File, Header, members};

/// Bytes before the HDF5 file.
const HEADER: usize = 512;
/// Most letters of a class in a message.
const LONGEST_CLASS: usize = 64;
/// The cure of what MATLAB does not write.
const SAVE: &str = "save it in MATLAB with `save -v7.3` or `save -v7`";

/// Whether `bytes` are of this version, however damaged.
pub(super) fn is_it(bytes: &[u8]) -> bool {
    bytes.starts_with(b"MATLAB 7.3") || bytes.get(HEADER..HEADER + 4) == Some(b"\x89HDF")
}

/// The variable `wanted`, or the only numeric array. Takes at most 24 bytes of memory for each
/// entry.
pub(super) fn read(name: &str, bytes: &[u8], wanted: Option<&str>) -> Result<Array, ArrayError> {
    let of_file = |fault| error_of(name, "it", fault);
    let file = File::new(bytes, HEADER).map_err(of_file)?;
    let mut choice = Choice::new(name, wanted);
    for member in members(&file).map_err(of_file)? {
        // What cells refer to, and objects of classes.
        if member.name.starts_with('#') {
            continue;
        }
        let variable = Variable::at(&file, member.header)
            .map_err(|fault| error_of(name, &subject(&member.name), fault))?;
        choice.offer(member.name, variable.is_numeric(), variable)?;
    }
    let (own, variable) = choice.made()?;
    variable.array(name, &own, file)
}

/// How messages name a variable.
fn subject(own: &str) -> String {
    format!("its variable `{own}`")
}

/// A fault of `subject` as an error of the file.
fn error_of(name: &str, subject: &str, fault: Fault) -> ArrayError {
    match fault {
        Fault::Damaged(reason) => damaged(name, format!("{subject} {reason}")),
        Fault::Unsupported(reason) => unsupported(name, format!("{subject} {reason}; {SAVE}")),
    }
}

/// What a variable says of itself before its numbers.
struct Variable<'a> {
    /// `None` for a link to somewhere else.
    header: Option<Header<'a>>,
    class: Option<&'a str>,
}

impl<'a> Variable<'a> {
    /// The variable whose header is at `address`.
    fn at(file: &File<'a>, address: Option<u64>) -> Result<Self, Fault> {
        let header = address.map(|at| Header::at(file, at)).transpose()?;
        let class = header.as_ref().and_then(|header| {
            let class = Attribute::of(header, "MATLAB_class")?;
            class.text()
        });
        Ok(Self { header, class })
    }

    /// Whether it is an array of plain numbers, or may be one.
    fn is_numeric(&self) -> bool {
        self.is_array() && (self.class.is_none() || self.number().is_some())
    }

    fn is_array(&self) -> bool {
        self.header.as_ref().is_some_and(Header::is_dataset)
    }

    /// The type of its numbers in MATLAB.
    fn number(&self) -> Option<Number> {
        Some(match self.class? {
            "double" => Number::Float(8),
            "single" => Number::Float(4),
            "int8" => Number::Signed(1),
            "uint8" | "logical" => Number::Unsigned(1),
            "int16" => Number::Signed(2),
            "uint16" => Number::Unsigned(2),
            "int32" => Number::Signed(4),
            "uint32" => Number::Unsigned(4),
            "int64" => Number::Signed(8),
            "uint64" => Number::Unsigned(8),
            _ => return None,
        })
    }

    /// The whole array.
    fn array(&self, name: &str, own: &str, file: File<'a>) -> Result<Array, ArrayError> {
        let no_numbers = |what: &str| {
            let reason = format!(
                "its variable `{own}` is {what}, no array of real numbers; save one that is"
            );
            unsupported(name, reason)
        };
        let number = self.number();
        let (Some(header), true) = (&self.header, self.is_array()) else {
            return Err(no_numbers(match self.class {
                Some("struct") => "a struct",
                Some(_) if number.is_some() => "sparse",
                _ => "an object or a link",
            }));
        };
        let Some(class) = self.class else {
            let reason = format!(
                "its variable `{own}` has no MATLAB_class, so the order of its indices is not known; \
                 {SAVE}, or in Python with numpy.save"
            );
            return Err(unsupported(name, reason));
        };
        let number = number.ok_or_else(|| {
            let class: String = class.chars().take(LONGEST_CLASS).collect();
            no_numbers(&format!("of class {class}"))
        })?;
        let is_empty = Attribute::of(header, "MATLAB_empty").is_some_and(|empty| empty.is_set());
        let of_variable = |fault| error_of(name, &subject(own), fault);
        let data = Dataset::new(file, header).map_err(of_variable)?;
        let shape: Vec<usize> = data.shape.iter().rev().copied().collect();
        // An empty array stores its lengths in place of numbers.
        entries(name, own, if is_empty { &[0] } else { &shape })?;
        let big = match data.datatype {
            Datatype::Number(stored, big) if stored == number => big,
            Datatype::Compound => return Err(no_numbers("complex")),
            _ => return Err(of_variable(Fault::Damaged("has numbers of another class"))),
        };
        let bytes = data.bytes(number.bytes()).map_err(of_variable)?;
        let values = number.all(name, &bytes, big)?;
        drop(bytes);
        Ok(Array {
            values: from_fortran(&shape, &values),
            full_scale: number.full_scale(),
            shape,
        })
    }
}

#[cfg(test)]
mod tests;
