//! The walks, compiled for each set of instructions.
#![expect(
    unsafe_code,
    reason = "calls into code compiled for a detected processor"
)]

use super::lanes::Packet;
use super::packet::{PacketStack, walk_packet};
use super::sight::{self, Points, Sight};
use super::simd::{Machine, Portable};
use super::stack::Stack;
use super::walk::{walk_closest, walk_occluded};
use super::{Bvh, PACKET};
use crate::geometry::Hit;
use crate::math::Ray;
use glam::Vec3;
use std::fmt;

/// Which of a processor's instructions answer ray queries; the answers do not depend on it.
///
/// Exists only for instructions that the processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kernel(Instructions);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Instructions {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Kernel {
    /// Plain code, for every processor.
    pub const PORTABLE: Kernel = Kernel(Instructions::Portable);

    /// All that this processor can run, the best last.
    pub fn available() -> Vec<Kernel> {
        let mut kernels = vec![Kernel::PORTABLE];
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            kernels.push(Kernel(Instructions::Avx2));
            if is_x86_feature_detected!("avx512f") {
                kernels.push(Kernel(Instructions::Avx512));
            }
        }
        kernels
    }
}

impl Default for Kernel {
    /// The best that this processor has.
    fn default() -> Kernel {
        Kernel::available().pop().unwrap_or(Kernel::PORTABLE)
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self.0 {
            Instructions::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2 => "AVX2",
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512 => "AVX-512",
        })
    }
}

struct PortableMachine;

impl Machine for PortableMachine {
    type One = Portable<8>;
    type Many = Portable<PACKET>;
}

/// The three walks, compiled for the instructions that a machine uses.
#[cfg(target_arch = "x86_64")]
macro_rules! compiled_for {
    ($module:ident, $features:literal, $one:ident, $many:ident) => {
        mod $module {
            use super::super::simd::{$many, $one};
            use super::*;

            struct Registers;

            impl Machine for Registers {
                type One = $one;
                type Many = $many;
            }

            #[target_feature(enable = $features)]
            pub(super) fn closest(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> Option<Hit> {
                walk_closest::<Registers>(bvh, ray, stack)
            }

            #[target_feature(enable = $features)]
            pub(super) fn occluded(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> bool {
                walk_occluded::<Registers>(bvh, ray, stack)
            }

            #[target_feature(enable = $features)]
            pub(super) fn look(points: &Points, target: Vec3) -> Sight {
                sight::look::<$many>(points, target)
            }

            #[target_feature(enable = $features)]
            pub(super) fn packet<const ANY: bool>(
                bvh: &Bvh,
                packet: &Packet,
                stack: &mut PacketStack,
            ) -> Option<[Hit; PACKET]> {
                walk_packet::<Registers, ANY>(bvh, packet, stack)
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
compiled_for!(avx2, "avx2,fma,bmi1,lzcnt,popcnt", Avx2, Avx2Pair);
#[cfg(target_arch = "x86_64")]
compiled_for!(avx512, "avx512f,avx2,fma,bmi1,lzcnt,popcnt", Avx2, Avx512);

pub(super) fn closest(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> Option<Hit> {
    match bvh.kernel.0 {
        Instructions::Portable => walk_closest::<PortableMachine>(bvh, ray, stack),
        // SAFETY: these kernels are only chosen where their instructions were detected.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 => unsafe { avx2::closest(bvh, ray, stack) },
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 => unsafe { avx512::closest(bvh, ray, stack) },
    }
}

pub(super) fn occluded(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> bool {
    match bvh.kernel.0 {
        Instructions::Portable => walk_occluded::<PortableMachine>(bvh, ray, stack),
        // SAFETY: these kernels are only chosen where their instructions were detected.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 => unsafe { avx2::occluded(bvh, ray, stack) },
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 => unsafe { avx512::occluded(bvh, ray, stack) },
    }
}

pub(super) fn look(bvh: &Bvh, points: &Points, target: Vec3) -> Sight {
    match bvh.kernel.0 {
        Instructions::Portable => sight::look::<Portable<PACKET>>(points, target),
        // SAFETY: these kernels are only chosen where their instructions were detected.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 => unsafe { avx2::look(points, target) },
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 => unsafe { avx512::look(points, target) },
    }
}

pub(super) fn packet<const ANY: bool>(
    bvh: &Bvh,
    packet: &Packet,
    stack: &mut PacketStack,
) -> Option<[Hit; PACKET]> {
    match bvh.kernel.0 {
        Instructions::Portable => walk_packet::<PortableMachine, ANY>(bvh, packet, stack),
        // SAFETY: these kernels are only chosen where their instructions were detected.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 => unsafe { avx2::packet::<ANY>(bvh, packet, stack) },
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 => unsafe { avx512::packet::<ANY>(bvh, packet, stack) },
    }
}
