//! References to primitives and their bounds, four lanes wide.

use crate::math::Aabb;
use glam::Vec4;

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
            max: bounds.max.extend(0.0),
        }
    }

    pub(super) fn id(&self) -> u32 {
        self.min.w.to_bits()
    }

    /// How many references the leaf has that starts with this one.
    pub(super) fn leaf_len(&self) -> usize {
        self.max.w.to_bits() as usize
    }

    pub(super) fn set_leaf_len(&mut self, len: usize) {
        self.max.w = f32::from_bits(len as u32);
    }

    /// Twice the box's centre.
    #[inline(always)]
    pub(super) fn doubled_center(&self) -> Vec4 {
        (self.min + self.max).truncate().extend(0.0)
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
        for reference in references {
            extent.add(reference);
        }
        extent
    }

    #[inline(always)]
    pub(super) fn add(&mut self, reference: &PrimitiveRef) {
        self.min = self.min.min(reference.min);
        self.max = self.max.max(reference.max);
        self.doubled_center_min = self.doubled_center_min.min(reference.doubled_center());
        self.doubled_center_max = self.doubled_center_max.max(reference.doubled_center());
    }
}
