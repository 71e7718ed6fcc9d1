//! Paths whose cameras are known in closed form.

use super::*;

#[test]
fn circles_and_helices_of_many_keys() {
    // The distance to the true curve, relative to its radius.
    for (count, error) in [(8_usize, 0.03), (16, 0.008), (64, 5e-4)] {
        let point = |turn: f64| DVec3::new((TAU * turn).cos(), 0.0, (TAU * turn).sin());
        let keys: Vec<Keyframe> = (0..=count)
            .map(|i| {
                let part = (i % count) as f64 / count as f64;
                key(i as f64 * 8.0 / count as f64, point(part), at(DVec3::NEG_Y))
            })
            .collect();
        for timing in [
            CLOSED,
            CameraPathTiming {
                closed: true,
                ..CONSTANT
            },
        ] {
            let path = CameraPath::new(30.0, &keys, &timing).expect("a circle");
            assert_eq!(path.timeline().frame_count(), 240);
            for (frame, camera) in cameras(&path).iter().enumerate() {
                let expected = point(frame as f64 / 240.0);
                assert!(
                    (camera.position - expected).length() < error,
                    "{count} {frame}"
                );
            }
            if timing.speed == Speed::Constant {
                // Also across the seam.
                let mut steps = steps(&path);
                steps.push(path.camera(239).position.distance(path.camera(0).position));
                assert!(
                    ratio(&steps) < 1.0 + 0.1 * error,
                    "{count}: {}",
                    ratio(&steps)
                );
            }
        }
        let rising = |turn: f64| point(turn) + DVec3::Y * turn;
        let keys: Vec<Keyframe> = (0..=3 * count)
            .map(|i| i as f64 / count as f64)
            .map(|turn| key(turn, rising(turn), AHEAD))
            .collect();
        let path = CameraPath::new(100.0, &keys, &CONSTANT).expect("a helix");
        for (frame, camera) in cameras(&path).iter().enumerate() {
            let expected = rising(frame as f64 / 100.0);
            // The first and the last segments have no neighbours to be bent by.
            let error = if (50..250).contains(&frame) {
                error
            } else {
                8.0 * error
            };
            assert!(
                (camera.position - expected).length() < error,
                "{count} {frame}"
            );
        }
    }
}

#[test]
fn lines_are_walked_at_constant_speed() {
    let places = [0.0, 0.1, 4.0, 4.0 + 1e-6, 9.0];
    let keys = places.map(|x| key(x * x + x, DVec3::new(2.0 * x, -x, x), AHEAD));
    for interpolation in [Interpolation::CatmullRom, Interpolation::Linear] {
        let path =
            CameraPath::new(10.0, &with(interpolation, keys.to_vec()), &CONSTANT).expect("keys");
        let count = f64::from(path.timeline().frame_count() - 1);
        for (frame, position) in positions(&path).iter().enumerate() {
            let x = 9.0 * frame as f64 / count;
            let error = (*position - DVec3::new(2.0 * x, -x, x)).length();
            assert!(error < 2e-11, "{frame}: {error}");
        }
    }
}

#[test]
fn constant_speed_on_uneven_paths() {
    // Equal times, from 0.4 to 5 m apart.
    let apart = [
        (0.0, 1.0, 0.0),
        (0.4, 1.0, 0.0),
        (5.2, 1.2, 1.4),
        (5.6, 1.3, 1.8),
        (5.0, 1.6, 5.0),
        (4.0, 1.6, 5.4),
    ];
    let apart = (0..).zip(apart).map(|(i, (x, y, z))| {
        let time = 299.0 / 24.0 * f64::from(i) / 5.0;
        key(time, DVec3::new(x, y, z), AHEAD)
    });
    for keys in [uneven(), apart.collect()] {
        let by_keys = CameraPath::new(24.0, &keys, &CameraPathTiming::BY_KEYS).expect("keys");
        assert_eq!(by_keys.timeline().frame_count(), 300);
        assert!(ratio(&steps(&by_keys)) > 5.0);
        let path = CameraPath::new(24.0, &keys, &CONSTANT).expect("keys");
        assert!(ratio(&steps(&path)) < 1.01, "{}", ratio(&steps(&path)));
        // Chords are shorter than arcs; for steps this short they are equal.
        let path = CameraPath::new(2400.0, &keys, &CONSTANT).expect("keys");
        let ratio = ratio(&steps(&path));
        assert!(ratio < 1.0001, "{ratio}");
    }
}

#[test]
fn a_zoom_magnifies_evenly() {
    let zoomed = |time: f64, degrees: f64| Keyframe {
        field_of_view: degrees.to_radians(),
        ..key(time, DVec3::ZERO, AHEAD)
    };
    for interpolation in [Interpolation::Linear, Interpolation::CatmullRom] {
        let keys = with(interpolation, vec![zoomed(0.0, 60.0), zoomed(10.0, 6.0)]);
        let path = CameraPath::new(10.0, &keys, &CameraPathTiming::BY_KEYS).expect("keys");
        let sizes: Vec<f64> = cameras(&path).iter().map(|c| c.half_height).collect();
        let first = sizes[0] / sizes[1];
        let expected = (30_f64.to_radians().tan() / 3_f64.to_radians().tan()).powf(0.01);
        assert!((first - expected).abs() < 1e-12);
        assert!(
            sizes
                .windows(2)
                .all(|s| (s[0] / s[1] - first).abs() < 1e-12)
        );
    }
}
