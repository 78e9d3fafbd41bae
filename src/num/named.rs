//! Enums whose values have names: on the command line, in files and in sentences.

/// Values that are asked for by name.
pub trait Named: Sized + 'static {
    /// The names, in order, each with what it means where the help says it.
    const NAMES: &'static [(&'static str, &'static str)];

    /// The value called so.
    fn by_name(name: &str) -> Option<Self>;
}

/// An enum with a name for each variant and, after a colon, what it means: `ALL`, `name`, `Display`
/// and [`Named`] follow.
macro_rules! named {
    ($(#[$about:meta])* $vis:vis enum $Enum:ident {
        $($(#[$doc:meta])* $Variant:ident = $name:literal $(: $help:literal)?,)+
    }) => {
        $(#[$about])*
        $vis enum $Enum {
            $($(#[$doc])* $Variant,)+
        }

        impl $Enum {
            /// Every value, in order.
            $vis const ALL: [Self; [$($name),+].len()] = [$(Self::$Variant),+];

            /// The name by which it is asked for and told.
            $vis fn name(self) -> &'static str {
                match self {
                    $(Self::$Variant => $name,)+
                }
            }
        }

        impl $crate::num::named::Named for $Enum {
            const NAMES: &'static [(&'static str, &'static str)] =
                &[$(($name, concat!($($help)?))),+];

            fn by_name(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|value| value.name() == name)
            }
        }

        impl std::fmt::Display for $Enum {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }
    };
}
pub(crate) use named;
