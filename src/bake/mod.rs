//! Bakes the irradiance cache of a camera path, before its first frame.
//!
//! 1. Views: how closely the frames see each surface at most.
//! 2. Placement: records in cells of space, as small as the closest view asks for where other surfaces are close.
//! 3. Gathering: path tracing gives the value of each record; paths end in secondary records, which are gathered as they
//!    are asked for. Where few paths find the light, more are traced.
//! 4. Gradients: a linear function is fitted to the values around each primary record.
//! 5. Validation: at held-out pixels the cache is compared with path tracing, which gives the cache error of each
//!    frame. Where it exceeds the target, all is baked again with more and smaller records.
//!
//! The result is a function of scene, path and settings: it does not depend on the number of threads, nor on which
//! frames are rendered with it.

mod bake_state;
mod cache_file;
mod candidates;
mod counter;
mod finest_view;
mod fit_gradients;
mod gather;
mod gathered_light;
mod least_squares;
mod neighbours;
mod placement;
mod validation;

use crate::camera::CameraPath;
use crate::irradiance_cache::IrradianceCache;
use crate::render::{ErrorEstimate, RenderSettings};
use crate::scene::Scene;
use bake_state::GATHERED;
pub use bake_state::{BakeState, Listener};
pub use cache_file::{CacheFile, CacheFileError};
use std::convert::Infallible;
pub use validation::cache_errors;

/// The baked irradiance cache of a camera path and its error.
#[derive(Debug)]
pub struct Baked {
    /// What a file keeps for other runs.
    pub state: BakeState,
    /// What frames interpolate.
    pub cache: IrradianceCache,
    /// The cache error of each frame of the path; empty if there are no bounces.
    pub errors: Vec<ErrorEstimate>,
    /// Whether the upper 95 % bound of the cache error is within its part of the target error, half. True without a
    /// target.
    pub reaches_target: bool,
}

/// Bakes the irradiance cache for all frames of a path, called `name`, of these settings, on the threads of the
/// current pool. A given state, of the same scene and settings, is extended by what this path lacks: what comes of it is the
/// same.
///
/// Of a target error the cache may take up half. If it takes up more, the records of the path are refined.
pub fn bake(
    scene: &Scene,
    path: &CameraPath,
    name: &str,
    settings: &RenderSettings,
    given: Option<BakeState>,
    listener: Listener,
) -> Baked {
    let reserve = |_| Ok::<(), Infallible>(());
    let Ok(baked) = bake_with_room(scene, path, name, settings, given, listener, reserve);
    baked
}

/// As [`bake`], but `reserve` hears of the bytes that the state will take in a file as soon as they are known, before
/// any light is gathered. Its error ends the bake.
pub fn bake_with_room<E>(
    scene: &Scene,
    path: &CameraPath,
    name: &str,
    settings: &RenderSettings,
    given: Option<BakeState>,
    listener: Listener,
    mut reserve: impl FnMut(u64) -> Result<(), E>,
) -> Result<Baked, E> {
    let bounces = settings.integrator.bounces();
    let mut state = given.unwrap_or_else(|| BakeState::new(bounces, settings.seed));
    let mut level = state.refinement_level(name);
    loop {
        let refinement_level = level.unwrap_or(0);
        if level.is_none() || state.refinement_level(name) != level {
            let size = (settings.width, settings.height);
            state.add_camera_path(
                scene,
                path,
                name,
                size,
                refinement_level,
                listener,
                &mut reserve,
            )?;
        }
        listener(GATHERED, "cache error");
        let cache = state
            .irradiance_cache(scene, name)
            .expect("the path is there");
        let errors = match state.errors(name, settings.display_white) {
            Some(errors) => errors.to_vec(),
            None => {
                let errors = cache_errors(scene, path, settings, &cache)
                    .expect("the cache is of the settings' bounces");
                state.set_errors(name, settings.display_white, &errors);
                errors
            }
        };
        let reaches_target = settings.target_error.is_none_or(|target| {
            let is_low = |error: &ErrorEstimate| error.interval()[1] <= 0.5 * target;
            errors.iter().all(is_low)
        });
        if reaches_target || refinement_level == BakeState::MAX_REFINEMENT {
            return Ok(Baked {
                state,
                cache,
                errors,
                reaches_target,
            });
        }
        level = Some(refinement_level + 1);
    }
}
