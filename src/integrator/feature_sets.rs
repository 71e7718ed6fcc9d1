//! Code compiled for each set of material features.

/// An array of a generic function's instances, one for each set of features, by [`FeatureSet::number`].
macro_rules! for_each_feature_set {
    ($($function:tt)+) => {{
        use crate::material::Only;
        [
            $($function)+::<Only<0>>,
            $($function)+::<Only<1>>,
            $($function)+::<Only<2>>,
            $($function)+::<Only<3>>,
            $($function)+::<Only<4>>,
            $($function)+::<Only<5>>,
            $($function)+::<Only<6>>,
            $($function)+::<Only<7>>,
            $($function)+::<Only<8>>,
            $($function)+::<Only<9>>,
            $($function)+::<Only<10>>,
            $($function)+::<Only<11>>,
            $($function)+::<Only<12>>,
            $($function)+::<Only<13>>,
            $($function)+::<Only<14>>,
            $($function)+::<Only<15>>,
        ]
    }};
}
pub(super) use for_each_feature_set;
