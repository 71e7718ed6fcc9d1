//! References to primitives and their bounds, four lanes wide.

use crate::math::Aabb;
use glam::Vec4;
use rayon::prelude::*;

/// Of more references, so many at a time are worked on in parallel.
pub(super) const PARALLEL_CHUNK: usize = 1 << 15;

/// The box around a primitive, and the primitive's number.
///
/// Four lanes, so that unions of boxes are vector instructions; the fourth of `min` holds the number, that of
/// `max`, in the first reference of a leaf, how many the leaf has.
#[derive(Clone, Copy, Debug)]
pub(super) struct PrimitiveRef {
    pub(super) min: Vec4,
    pub(super) max: Vec4,
}

impl PrimitiveRef {
    pub(super) fn new(bounds: Aabb, id: u32) -> PrimitiveRef {
        PrimitiveRef {
            min: bounds.min.extend(f32::from_bits(id)),
            max: bounds.max.extend(1.0),
        }
    }

    pub(super) fn id(&self) -> u32 {
        self.min.w.to_bits()
    }

    /// How many references the leaf has that starts with this one; 1 if none does.
    pub(super) fn leaf_len(&self) -> usize {
        self.max.w as usize
    }

    pub(super) fn set_leaf_len(&mut self, len: usize) {
        self.max.w = len as f32;
    }

    /// Twice the box's centre, and a fourth number that is not denormal, which would be slow.
    #[inline(always)]
    pub(super) fn doubled_center(&self) -> Vec4 {
        self.min + self.max
    }
}

/// The box around references, and the box around twice their centres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) min: Vec4,
    pub(super) max: Vec4,
    pub(super) doubled_center_min: Vec4,
    pub(super) doubled_center_max: Vec4,
}

impl Extent {
    pub(super) const EMPTY: Extent = Extent {
        min: Vec4::INFINITY,
        max: Vec4::NEG_INFINITY,
        doubled_center_min: Vec4::INFINITY,
        doubled_center_max: Vec4::NEG_INFINITY,
    };

    pub(super) fn of(references: &[PrimitiveRef]) -> Extent {
        let mut extent = Extent::EMPTY;
        if references.len() > PARALLEL_CHUNK {
            let chunks = references.par_chunks(PARALLEL_CHUNK);
            for part in chunks.map(Extent::of).collect::<Vec<_>>() {
                extent = extent.union(&part);
            }
        } else {
            for reference in references {
                extent.add(reference);
            }
        }
        extent
    }

    #[inline(always)]
    fn add(&mut self, reference: &PrimitiveRef) {
        let center = reference.doubled_center();
        *self = self.union(&Extent {
            min: reference.min,
            max: reference.max,
            doubled_center_min: center,
            doubled_center_max: center,
        });
    }

    #[inline(always)]
    fn union(&self, other: &Extent) -> Extent {
        Extent {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            doubled_center_min: self.doubled_center_min.min(other.doubled_center_min),
            doubled_center_max: self.doubled_center_max.max(other.doubled_center_max),
        }
    }
}
