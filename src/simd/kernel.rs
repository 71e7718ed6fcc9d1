//! The one place where code is chosen by instruction set: a [`Kernel`] runs a [`WithSimd`] task, compiled
//! for each set.
#![expect(
    unsafe_code,
    reason = "calls into code compiled for a detected processor"
)]

use super::doubles::Doubles;
use super::floats::{Floats, PACKET_WIDTH};
use super::portable::{PortableDoubles, PortableFloats};
use std::fmt;

/// The instruction set that answers ray queries and irradiance lookups; results do not depend on it.
///
/// Exists only for instructions that the processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kernel(InstructionSet);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum InstructionSet {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// The vectors of an instruction set.
pub(crate) trait Simd {
    /// One ray against eight boxes or triangles.
    type F32x8: Floats<8>;
    /// A packet of rays against one box or triangle.
    type F32x16: Floats<PACKET_WIDTH>;
    /// Exact distances of eight triangles, or of half a packet.
    type F64x8: Doubles<8, Floats = Self::F32x8>;

    /// Columns from rows.
    fn transpose(rows: [Self::F32x8; 8]) -> [Self::F32x8; 8];

    /// The lanes of `low`, then those of `high`.
    fn join(low: Self::F32x8, high: Self::F32x8) -> Self::F32x16;

    /// Asks for a value that will be read soon; where there is no instruction for that, nothing.
    #[inline(always)]
    fn prefetch<T>(_value: &T) {}
}

/// A computation that is written once and compiled for every instruction set.
pub(crate) trait WithSimd {
    type Output;

    /// Implementations are `#[inline(always)]`, and so is what they call: only what is inlined into
    /// [`Kernel::run`] is compiled for the instruction set.
    fn with_simd<S: Simd>(self) -> Self::Output;
}

impl Kernel {
    /// No vector instructions, for every processor.
    pub const PORTABLE: Kernel = Kernel(InstructionSet::Portable);

    /// All that this processor can run, the fastest last.
    pub fn available() -> Vec<Kernel> {
        let mut kernels = vec![Kernel::PORTABLE];
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt")
        {
            kernels.push(Kernel(InstructionSet::Avx2));
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
            {
                kernels.push(Kernel(InstructionSet::Avx512));
            }
        }
        kernels
    }

    /// Runs a task compiled for this instruction set.
    pub(crate) fn run<T: WithSimd>(self, task: T) -> T::Output {
        match self.0 {
            InstructionSet::Portable => task.with_simd::<Portable>(),
            // SAFETY: `available` makes these kernels only where all features of `avx2::run` were detected.
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => unsafe { avx2::run(task) },
            // SAFETY: as above, for the features of `avx512::run`.
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => unsafe { avx512::run(task) },
        }
    }
}

impl Default for Kernel {
    /// The fastest that this processor has.
    fn default() -> Kernel {
        Kernel::available().pop().unwrap_or(Kernel::PORTABLE)
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self.0 {
            InstructionSet::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => "AVX2",
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => "AVX-512",
        })
    }
}

struct Portable;

impl Simd for Portable {
    type F32x8 = PortableFloats<8>;
    type F32x16 = PortableFloats<PACKET_WIDTH>;
    type F64x8 = PortableDoubles<8>;

    #[inline(always)]
    fn transpose(rows: [PortableFloats<8>; 8]) -> [PortableFloats<8>; 8] {
        PortableFloats::transpose(rows)
    }

    #[inline(always)]
    fn join(low: PortableFloats<8>, high: PortableFloats<8>) -> PortableFloats<PACKET_WIDTH> {
        PortableFloats::join(low, high)
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::super::pair::Avx2FloatsPair;
    use super::super::x86_64::{Avx2Floats, prefetch};
    use super::super::x86_64_doubles::Avx2Doubles;
    use super::{Simd, WithSimd};

    struct Avx2;

    impl Simd for Avx2 {
        type F32x8 = Avx2Floats;
        type F32x16 = Avx2FloatsPair;
        type F64x8 = Avx2Doubles;

        #[inline(always)]
        fn transpose(rows: [Avx2Floats; 8]) -> [Avx2Floats; 8] {
            Avx2Floats::transpose(rows)
        }

        #[inline(always)]
        fn join(low: Avx2Floats, high: Avx2Floats) -> Avx2FloatsPair {
            Avx2FloatsPair::join(low, high)
        }

        #[inline(always)]
        fn prefetch<T>(value: &T) {
            prefetch(value);
        }
    }

    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    pub(super) fn run<T: WithSimd>(task: T) -> T::Output {
        task.with_simd::<Avx2>()
    }
}

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use super::super::x86_64::{Avx2Floats, Avx512Floats, prefetch};
    use super::super::x86_64_doubles::Avx512Doubles;
    use super::{Simd, WithSimd};

    struct Avx512;

    impl Simd for Avx512 {
        type F32x8 = Avx2Floats;
        type F32x16 = Avx512Floats;
        type F64x8 = Avx512Doubles;

        #[inline(always)]
        fn transpose(rows: [Avx2Floats; 8]) -> [Avx2Floats; 8] {
            Avx2Floats::transpose(rows)
        }

        #[inline(always)]
        fn join(low: Avx2Floats, high: Avx2Floats) -> Avx512Floats {
            Avx512Floats::join(low, high)
        }

        #[inline(always)]
        fn prefetch<T>(value: &T) {
            prefetch(value);
        }
    }

    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,lzcnt,popcnt")]
    pub(super) fn run<T: WithSimd>(task: T) -> T::Output {
        task.with_simd::<Avx512>()
    }
}
