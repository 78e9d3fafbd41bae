//! The dual image: a traced light-transport matrix transposed, and why transposing is not
//! inverting.
//!
//! T of c′ = T p′ is the Φcam that is traced for a projector whose pixels are the laser spots of
//! the scene `dual`. Its transpose is the light transport with projector and camera exchanged, as
//! in Sen et al., *Dual Photography* (ACM Transactions on Graphics 24(3), 2005). There each
//! projector pixel lights the one scene point that is to be seen, and the transpose shows it. Here
//! projector and camera see the same Lambertian wall, and what is hidden is seen by one more
//! diffuse reflection on either way: the dual image is another photograph of the wall. The board is
//! in T = C diag(ρ) D, but G12 and G23 have to be inverted to see it; their transposes would do
//! that only if the singular values of T were all equal.

mod adjoint;
mod checks;
mod figure;
mod judged;
mod pair;
mod reciprocity;
mod spectrum;
#[cfg(test)]
mod tests;

pub(super) use figure::figure;
