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

/// A set of features, by its [`FeatureSet::number`].
#[derive(Debug)]
pub struct Only<const NUMBER: usize>;

impl<const NUMBER: usize> Features for Only<NUMBER> {
    const TEXTURES: bool = NUMBER & 1 != 0;
    const HIGHLIGHTS: bool = NUMBER & 2 != 0;
    const MIRRORS: bool = NUMBER & 4 != 0;
    const MIXTURES: bool = NUMBER & 8 != 0;
}

// As FeatureSet numbers them.
const _: () = assert!(Only::<1>::TEXTURES && Only::<2>::HIGHLIGHTS && !Only::<13>::HIGHLIGHTS);
const _: () = assert!(Only::<4>::MIRRORS && Only::<8>::MIXTURES && !Only::<11>::MIRRORS);

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

    /// The number of the set, below [`FeatureSet::COUNT`].
    pub fn number(self) -> usize {
        self.0
    }
}
