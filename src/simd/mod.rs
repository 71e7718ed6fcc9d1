//! Vectors of floats with the same bits on every processor, and the one choice of instruction set.
//!
//! Code is written once over `Simd` and `Floats` as a `WithSimd` task, and a [`Kernel`] runs it compiled
//! for the instruction set of the processor. `PortableFloats` are plain arrays; the others are the same
//! arithmetic in vector registers. Apart from `Floats::mul_sub` nothing is fused or reordered, so all
//! kernels give the same results to the bit.

mod doubles;
mod floats;
mod kernel;
#[cfg(target_arch = "x86_64")]
mod pair;
mod portable;
mod set_bits;
#[cfg(target_arch = "x86_64")]
mod x86_64;
#[cfg(target_arch = "x86_64")]
mod x86_64_doubles;

pub(crate) use doubles::Doubles;
pub use floats::PACKET_WIDTH;
pub(crate) use floats::{ALL_LANES, Floats};
pub use kernel::Kernel;
pub(crate) use kernel::{Simd, WithSimd};
#[cfg(test)]
pub(crate) use portable::PortableFloats;
pub(crate) use portable::{Scalar, ScalarDouble};
pub(crate) use set_bits::SetBits;

#[cfg(all(test, target_arch = "x86_64"))]
mod tests;
