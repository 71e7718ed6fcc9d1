//! Code compiled for each set of material features.

/// An array of a generic function's instances, one for each set of features, by
/// [`FeatureSet::index`](crate::material::FeatureSet::index).
macro_rules! for_each_feature_set {
    ($($function:tt)+) => {{
        use crate::material::FeatureMask;
        [
            $($function)+::<FeatureMask<0>>,
            $($function)+::<FeatureMask<1>>,
            $($function)+::<FeatureMask<2>>,
            $($function)+::<FeatureMask<3>>,
            $($function)+::<FeatureMask<4>>,
            $($function)+::<FeatureMask<5>>,
            $($function)+::<FeatureMask<6>>,
            $($function)+::<FeatureMask<7>>,
            $($function)+::<FeatureMask<8>>,
            $($function)+::<FeatureMask<9>>,
            $($function)+::<FeatureMask<10>>,
            $($function)+::<FeatureMask<11>>,
            $($function)+::<FeatureMask<12>>,
            $($function)+::<FeatureMask<13>>,
            $($function)+::<FeatureMask<14>>,
            $($function)+::<FeatureMask<15>>,
        ]
    }};
}
pub(super) use for_each_feature_set;
