//! Works out the indirect light that a camera path needs, before its first frame.
//!
//! First the places are chosen, by geometry alone: what the frames see is covered with discs, smaller where
//! other surfaces are close; and so, more coarsely, is what can be seen from there. Then the light of each
//! place is gathered: of the coarse ones for one bounce, for two, and so on, each from the last; and with
//! these that of the fine ones. Each place learns from its neighbours how light changes. At last what is looked
//! up is held against exact light at pixels chosen by chance: the error is known before the first frame, and
//! where it is more than is wanted, all is done again with more and smaller places.
//!
//! All of it is a function of scene, path and settings: the same for any number of threads, and for whichever
//! frames are rendered with it.

mod bake_state;
mod cache_file;
mod candidates;
mod fit;
mod gather;
mod order;
mod placement;

use crate::camera::CameraPath;
use crate::render::{ErrorEstimate, PixelSampling, RenderSettings, cache_errors};
use crate::scene::Scene;
pub use bake_state::BakeState;
pub use cache_file::{CacheFile, CacheFileError};
use std::sync::Arc;

/// Is told how far the work is, of 1, and what is done now.
pub type Listener<'a> = &'a (dyn Fn(f64, &'static str) + Sync);

/// The light of a path.
#[derive(Debug)]
pub struct Baked {
    /// What can be kept for other runs.
    pub cache: BakeState,
    /// The settings of frames that look it up.
    pub settings: RenderSettings,
    /// Whether its error leaves room for a target error. Always if there is none.
    pub reaches_target: bool,
}

/// Works out the light for all frames of a path, called `name`, whose settings gather light exactly, on the
/// threads of the current pool. With a cache of the same scene and settings only what is missing there is
/// added.
///
/// Where a target error is set, the light may take half of it, or all where camera samples have no error. If it
/// takes more, finer light is worked out; not so if a cache is given, which holds the light of other paths, too.
pub fn bake(
    scene: &Scene,
    path: &CameraPath,
    name: &str,
    exact: &RenderSettings,
    given: Option<BakeState>,
    listener: Listener,
) -> Baked {
    let is_given = given.is_some();
    let new = |fineness| BakeState::new(scene, exact.integrator.bounces(), exact.seed, fineness);
    let mut cache = given.unwrap_or_else(|| new(0));
    loop {
        if !cache.covers(name) {
            cache.extend(scene, path, name, (exact.width, exact.height), listener);
        }
        listener(0.97, "error of the light");
        let mut settings = exact.looking_up(Arc::new(cache.illumination()));
        settings.cache_errors = match cache.errors(name, exact.white) {
            Some(errors) => errors.into(),
            None => {
                let errors = cache_errors(scene, path, &settings);
                cache.learn(name, exact.white, &errors);
                errors.into()
            }
        };
        let reaches_target = exact.target_error.is_none_or(|target| {
            let share = match exact.sampling {
                PixelSampling::Spread(_) => 0.5,
                PixelSampling::Center | PixelSampling::Corners => 1.0,
            };
            let is_low = |error: &ErrorEstimate| error.interval()[1] <= share * target;
            settings.cache_errors.iter().all(is_low)
        });
        if reaches_target || is_given || cache.fineness() == BakeState::FINEST {
            return Baked {
                cache,
                settings,
                reaches_target,
            };
        }
        cache = new(cache.fineness() + 1);
    }
}
