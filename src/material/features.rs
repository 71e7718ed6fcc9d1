use super::Material;

/// What the surfaces of a scene need. Code that is generic over it is compiled for each set: what a
/// scene does not need costs it no branch and no fetch.
pub trait Features {
    /// Some material has a texture.
    const TEXTURES: bool;
    /// Some material has a highlight.
    const HIGHLIGHTS: bool;
    /// Some material is a mirror.
    const MIRRORS: bool;
    /// Some triangle mixes the materials of its corners.
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

/// The features that a scene needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeatureSet(usize);

impl FeatureSet {
    /// How many sets there are.
    pub const COUNT: usize = 16;

    /// What these materials need; `mixes` says whether a triangle mixes some.
    pub fn of(materials: &[Material], mixes: bool) -> FeatureSet {
        let any = |needs: fn(&Material) -> bool| usize::from(materials.iter().any(needs));
        let textures = any(|m| m.texture.is_some());
        let highlights = any(|m| m.specular != glam::Vec3::ZERO);
        let mirrors = any(|m| m.reflective != glam::Vec3::ZERO);
        FeatureSet(textures | highlights << 1 | mirrors << 2 | usize::from(mixes) << 3)
    }

    /// The number of the set, below [`FeatureSet::COUNT`].
    pub fn number(self) -> usize {
        self.0
    }
}
