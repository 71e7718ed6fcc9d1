//! Bakes of irradiance caches: interrupted, refined, and what frames do whose target error they miss.

use crate::irradiance_cache::{SIZE, across_the_room, baked, box_of, cached_settings, glide};
use crate::support::*;
use flythrough::bake::{BakeKeeper, BakeState, Baked, bake, bake_kept};
use flythrough::integrator::IntegratorSettings;
use flythrough::metrics::normaliser;
use flythrough::render::{Aov, PixelSampling, RenderSettings, Renderer};
use glam::{DVec3, Vec3};

/// Ends a bake at a checkpoint.
struct Interrupt {
    checkpoints_left: u32,
}

impl BakeKeeper for Interrupt {
    /// The state as a file keeps it.
    type Error = Vec<u8>;

    fn reserve(&mut self, _: u64) -> Result<(), Vec<u8>> {
        Ok(())
    }

    fn checkpoint(&mut self, state: &BakeState) -> Result<(), Vec<u8>> {
        match self.checkpoints_left {
            0 => Err(kept(state)),
            _ => {
                self.checkpoints_left -= 1;
                Ok(())
            }
        }
    }
}

fn kept(state: &BakeState) -> Vec<u8> {
    postcard::to_allocvec(state).unwrap()
}

/// A bake that was interrupted goes on where it was, and comes to the same.
#[test]
fn interrupted_bakes_go_on() {
    let scene = shipped_scene("test3.ron");
    let path = across_the_room();
    let settings = cached_settings(2);
    let whole = kept(&baked(&scene, &path, 2).state);
    let mut given = None;
    for checkpoints_left in [0, 0, 1] {
        let keeper = &mut Interrupt { checkpoints_left };
        let interrupted = bake_kept(&scene, &path, "path", &settings, given, &|_, _| (), keeper);
        let state = interrupted.expect_err("interrupted");
        assert!(state.len() < whole.len());
        let state: BakeState = postcard::from_bytes(&state).unwrap();
        assert_eq!(state.refinement_level("path"), None);
        given = Some(state);
    }
    let resumed = bake(&scene, &path, "path", &settings, given, &|_, _| ());
    assert!(kept(&resumed.state) == whole);
}

/// Frames whose cache leaves too little of the target error are those of path tracing, and others those of the cache.
#[test]
fn frames_that_the_cache_misses_are_path_traced() {
    let scene = shipped_scene("test3.ron");
    let path = across_the_room();
    let target = 0.02;
    let adaptive = RenderSettings {
        sampling: PixelSampling::Spread(1),
        target_error: Some(target),
        ..settings(IntegratorSettings::Cached { bounces: 1 }, 24, 18)
    };
    let baked = bake(&scene, &path, "path", &adaptive, None, &|_, _| ());
    assert!(baked.missed.is_empty());
    let mut errors = baked.errors.clone();
    errors[3].rel_mse = 0.51 * target;
    let cached = Renderer::new(&scene, adaptive.clone(), Some(&baked.cache)).unwrap();
    let by_paths = RenderSettings {
        integrator: monte_carlo(1, &[32]),
        ..adaptive
    };
    let path_traced = Renderer::new(&scene, by_paths, None).unwrap();
    let alone = cached.clone().with_cache_errors(&baked.errors);
    let both = cached.with_cache_errors(&errors);
    for (number, expected) in [(3, &path_traced), (4, &alone)] {
        let [frame, expected] =
            [&both, expected].map(|renderer| renderer.render_frame(&path.camera(number), number));
        assert_eq!(frame.film.pixels(), expected.film.pixels());
        assert_eq!(frame.error, expected.error);
        assert!(frame.error.whole.interval()[1] <= target);
    }
}

/// The map of the cache error makes up that of the frame, and is bright where the cache is off.
#[test]
fn the_map_of_the_cache_error_shows_where_it_is() {
    let scene = shipped_scene("test3.ron");
    let path = across_the_room();
    let baked = baked(&scene, &path, 4);
    let halves = baked.cache.halves();
    let settings = cached_settings(4);
    let renderer = Renderer::new(&scene, settings.clone(), Some(&baked.cache)).unwrap();
    let renderer = renderer
        .with_cache_errors(&baked.errors)
        .with_cache_halves(&halves);
    let camera = path.camera(4);
    let frame = renderer.render_frame(&camera, 4);
    let map = frame.map(Aov::CacheError);
    let pixels = frame.film.pixels();
    let relative = |index: usize, squared: Vec3| -> f64 {
        let square = normaliser(pixels, SIZE.0 as usize, index, 1, 1.0);
        f64::from((squared / square).element_sum() / 3.0)
    };
    let errors = map.pixels().iter().enumerate();
    let claimed: Vec<f64> = errors.map(|(i, e)| relative(i, *e * *e)).collect();
    let mean = claimed.iter().sum::<f64>() / claimed.len() as f64;
    let error = baked.errors[4].rel_mse;
    assert!((mean - error).abs() < 1e-3 * error, "{mean} {error}");
    let by_paths = RenderSettings {
        integrator: monte_carlo(4, &[scaled(256, 512, 4096)]),
        ..settings
    };
    let oracle = Renderer::new(&scene, by_paths, None).unwrap();
    let all: Vec<(u32, u32)> = (0..SIZE.0 * SIZE.1)
        .map(|number| (number % SIZE.0, number / SIZE.0))
        .collect();
    let oracle = oracle.render_pixels(&camera, 4, &all);
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|&a, &b| claimed[a].total_cmp(&claimed[b]));
    let (low, high) = order.split_at(order.len() / 2);
    let true_error = |indices: &[usize]| -> f64 {
        let of = |&i: &usize| {
            let [a, b] = oracle[i];
            relative(i, (pixels[i] - a) * (pixels[i] - b))
        };
        indices.iter().map(of).sum()
    };
    let (low, high) = (true_error(low), true_error(high));
    assert!(high > 2.0 * low.abs(), "{low} {high}");
}

/// A target that no cache reaches is tried for with smaller and smaller cells; then the frames are named.
#[test]
fn refinement_ends() {
    let scene = scene(&format!(
        "Scene({GREY} lights: [{}], objects: [{}])",
        light("(-1, 1, 1)", 5.0),
        box_of("grey", -2.0, 2.0)
    ));
    let eye = DVec3::new(-1.8, 1.2, 1.7);
    let path = glide([eye, eye], DVec3::new(0.0, 1.0, 0.0));
    let missing = RenderSettings {
        target_error: Some(1e-9),
        ..cached_settings(1)
    };
    let reached = RenderSettings {
        target_error: Some(0.5),
        ..cached_settings(1)
    };
    let [missing, reached] =
        [missing, reached].map(|settings| bake(&scene, &path, "path", &settings, None, &|_, _| ()));
    assert_eq!(missing.missed, (0..9).collect::<Vec<u32>>());
    let level = |baked: &Baked| baked.state.refinement_level("path");
    assert_eq!(level(&missing), Some(BakeState::MAX_REFINEMENT));
    assert!(reached.missed.is_empty());
    assert_eq!(level(&reached), Some(0));
    let records = |baked: &Baked| baked.cache.record_count()[0];
    assert!(records(&missing) > 3 * records(&reached));
}
