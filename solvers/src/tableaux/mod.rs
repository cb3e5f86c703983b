//! The coefficients of methods, each a file named after its authors.

mod bogacki_shampine_3;
mod classical_4;
mod dormand_prince_5;
mod dormand_prince_853;
mod kutta_43;
mod radau_iia_5;
mod rodas_5p;
mod verner_98;

pub use bogacki_shampine_3::BOGACKI_SHAMPINE_3;
pub use classical_4::CLASSICAL_4;
pub use dormand_prince_5::DORMAND_PRINCE_5;
pub use dormand_prince_853::DORMAND_PRINCE_853;
pub use kutta_43::KUTTA_43;
pub use radau_iia_5::RADAU_IIA_5;
pub use rodas_5p::RODAS_5P;
pub use verner_98::VERNER_98;
