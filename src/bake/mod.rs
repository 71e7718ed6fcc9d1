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
mod validation;

use crate::camera::CameraPath;
use crate::irradiance_cache::IrradianceCache;
use crate::render::{ErrorEstimate, PixelSampling, RenderSettings};
use crate::scene::Scene;
pub use bake_state::BakeState;
pub use cache_file::{CacheFile, CacheFileError};
pub use validation::cache_errors;

/// Is told how far the work is, of 1, and what is done now.
pub type Listener<'a> = &'a (dyn Fn(f64, &'static str) + Sync);

/// The irradiance cache of a path, and how good it is.
#[derive(Debug)]
pub struct Baked {
    /// What can be kept for other runs.
    pub state: BakeState,
    /// What frames look up.
    pub cache: IrradianceCache,
    /// The cache's error in each frame of the path; empty if there are no bounces.
    pub errors: Vec<ErrorEstimate>,
    /// Whether the errors leave room for the target error. Always if there is none.
    pub reaches_target: bool,
}

/// Bakes the irradiance cache for all frames of a path, called `name`, of these settings, on the threads of the
/// current pool. With a state of the same scene and settings only what is missing there is added.
///
/// Where a target error is set, the cache may take half of it, or all where camera samples have no error. If it
/// takes more, a finer cache is baked; not so if a state is given, which holds the light of other paths, too.
pub fn bake(
    scene: &Scene,
    path: &CameraPath,
    name: &str,
    settings: &RenderSettings,
    given: Option<BakeState>,
    listener: Listener,
) -> Baked {
    let is_given = given.is_some();
    let bounces = settings.integrator.bounces();
    let new = |fineness| BakeState::new(scene, bounces, settings.seed, fineness);
    let mut state = given.unwrap_or_else(|| new(0));
    loop {
        if !state.covers(name) {
            state.extend(
                scene,
                path,
                name,
                (settings.width, settings.height),
                listener,
            );
        }
        listener(0.97, "error of the light");
        let cache = state.illumination();
        let errors = match state.errors(name, settings.display_white) {
            Some(errors) => errors.to_vec(),
            None => {
                let errors = cache_errors(scene, path, settings, &cache)
                    .expect("the cache is of the settings' bounces");
                state.learn(name, settings.display_white, &errors);
                errors
            }
        };
        let reaches_target = settings.target_error.is_none_or(|target| {
            let fraction = match settings.sampling {
                PixelSampling::Spread(_) => 0.5,
                PixelSampling::Center | PixelSampling::Corners => 1.0,
            };
            let is_low = |error: &ErrorEstimate| error.interval()[1] <= fraction * target;
            errors.iter().all(is_low)
        });
        if reaches_target || is_given || state.fineness() == BakeState::FINEST {
            return Baked {
                state,
                cache,
                errors,
                reaches_target,
            };
        }
        state = new(state.fineness() + 1);
    }
}
