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
        for reference in references {
            extent.add(reference);
        }
        extent
    }

    #[inline(always)]
    pub(super) fn add(&mut self, reference: &PrimitiveRef) {
        self.min = self.min.min(reference.min);
        self.max = self.max.max(reference.max);
        self.add_center(reference.doubled_center());
    }

    #[inline(always)]
    pub(super) fn add_center(&mut self, doubled_center: Vec4) {
        self.doubled_center_min = self.doubled_center_min.min(doubled_center);
        self.doubled_center_max = self.doubled_center_max.max(doubled_center);
    }
}
