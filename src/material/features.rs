//! Which features of materials a scene uses, known at compile time to the code that shades it.

/// The features that the surfaces of a scene use. Code that is generic over it is compiled for each set: what a
/// scene does not use costs it no branch and no fetch.
pub trait Features {
    /// Some material has a texture.
    const TEXTURES: bool;
    /// Some material has a highlight.
    const HIGHLIGHTS: bool;
    /// Some material is a mirror.
    const MIRRORS: bool;
    /// Some triangle mixes the materials of its vertices.
    const MIXTURES: bool;
}

/// A set of features, by the bits of its [`FeatureSet::index`].
#[derive(Debug)]
pub struct FeatureMask<const BITS: usize>;

impl<const BITS: usize> Features for FeatureMask<BITS> {
    const TEXTURES: bool = BITS & 1 != 0;
    const HIGHLIGHTS: bool = BITS & 2 != 0;
    const MIRRORS: bool = BITS & 4 != 0;
    const MIXTURES: bool = BITS & 8 != 0;
}

// As FeatureSet numbers them.
const _: () = assert!(
    FeatureMask::<1>::TEXTURES && FeatureMask::<2>::HIGHLIGHTS && !FeatureMask::<13>::HIGHLIGHTS
);
const _: () =
    assert!(FeatureMask::<4>::MIRRORS && FeatureMask::<8>::MIXTURES && !FeatureMask::<11>::MIRRORS);

/// The features that a scene uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeatureSet(usize);

impl FeatureSet {
    /// How many sets there are.
    pub const COUNT: usize = 16;

    /// A set of features; `mixtures` says whether a triangle mixes the materials of its vertices.
    pub fn new(textures: bool, highlights: bool, mirrors: bool, mixtures: bool) -> FeatureSet {
        let flags = [textures, highlights, mirrors, mixtures];
        let bits = (0..).zip(flags).map(|(bit, flag)| usize::from(flag) << bit);
        FeatureSet(bits.sum())
    }

    /// The index of the set, below [`FeatureSet::COUNT`].
    pub fn index(self) -> usize {
        self.0
    }
}
