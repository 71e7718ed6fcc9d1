//! Frames are the same bits for any number of threads; noise depends on seed and frame.

use crate::support::*;
use flythrough::integrator::{CameraSample, Integrator};
use flythrough::render::{PixelSampling, RenderSettings};
use glam::Vec3;

fn on_threads(threads: usize, settings: &RenderSettings, frame: u32) -> Vec<Vec3> {
    let scene = shipped_scene("test2.ron");
    let camera = shipped_path("zoom.ron").camera(frame);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    let rendered = pool.install(|| renderer(&scene, settings).render_frame(&camera, frame));
    rendered.film.pixels().to_vec()
}

#[test]
fn one_thread_or_many_give_the_same_bits() {
    for sampling in [
        PixelSampling::Center,
        PixelSampling::Corners,
        PixelSampling::Spread(3),
    ] {
        let mut settings = settings(monte_carlo(3, &[4, 2]), 61, 35);
        settings.sampling = sampling;
        let one = on_threads(1, &settings, 7);
        assert_eq!(one, on_threads(5, &settings, 7), "{sampling:?}");
    }
    for integrator in [monte_carlo(3, &[4, 2]), ray_tracing()] {
        let mut settings = settings(integrator, 61, 35);
        settings.sampling = PixelSampling::Spread(1);
        let few = on_threads(1, &settings, 7);
        settings.target_error = Some(0.01);
        let refined = on_threads(1, &settings, 7);
        assert_ne!(few, refined);
        assert_eq!(refined, on_threads(5, &settings, 7));
    }
}

#[test]
fn seeds_and_frames_have_noise_of_their_own() {
    let mut settings = settings(monte_carlo(2, &[1]), 16, 9);
    // The first and the last frame of this path have the same camera.
    let last = shipped_path("zoom.ron").timeline().frame_count() - 1;
    let first = on_threads(2, &settings, 0);
    assert_ne!(first, on_threads(2, &settings, last));
    settings.seed = 1;
    assert_ne!(first, on_threads(2, &settings, 0));
}

/// Corner samples that pixels share give exactly the mean of four samples of each pixel.
#[test]
fn corners_equal_four_samples_of_each_pixel() {
    let scene = shipped_scene("test.ron");
    let camera = shipped_path("test.ron").camera(0);
    let (width, height) = (24, 18);
    let mut settings = settings(ray_tracing(), width, height);
    settings.sampling = PixelSampling::Corners;
    let shared = render(&scene, &camera, &settings);
    let size = glam::DVec2::new(width.into(), height.into());
    let integrator = Integrator::new(&scene, &settings.integrator, None).unwrap();
    let mut query_state = flythrough::accel::QueryState::default();
    for y in 0..height {
        for x in 0..width {
            let mut corner = |dx: f64, dy: f64| {
                let film = glam::DVec2::new(f64::from(x) + 0.5 + dx, f64::from(y) + 0.5 + dy);
                let ray = camera.rays(size, scene.origin).through(film);
                let sequence = flythrough::sampling::SobolSequence::new(0, 0, 0, 0);
                let sample = CameraSample {
                    ray,
                    sequence,
                    index: 0,
                };
                let mut radiance = [glam::Vec3::ZERO];
                integrator.radiance(&[sample], &[], &mut query_state, &mut radiance);
                radiance[0]
            };
            let upper = corner(-0.5, -0.5) + corner(0.5, -0.5);
            let mean = 0.25 * (upper + (corner(-0.5, 0.5) + corner(0.5, 0.5)));
            assert_eq!(shared[(y * width + x) as usize], mean);
        }
    }
}
