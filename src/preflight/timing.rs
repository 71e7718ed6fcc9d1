//! Paths and keyframes that are shorter than a frame.

use super::{FrameRuns, PathWarning, WarningKind};
use crate::camera::CameraPath;
use glam::DVec2;

/// Tolerance for "less than a frame": times in files are rounded.
const LESS: f64 = 0.95;

/// The least median of the frames between keyframes of a path that is keyed by hand: paths of other programs have a
/// keyframe for each of their own frames.
const BY_HAND: f64 = 2.0;

/// The least ratio of the speed of a leap to that of the moves beside it: close keyframes of a steady move do no harm.
const FAST: f64 = 4.0;

/// The least move that counts, relative to the coordinates, and the least turn, in radians.
const LEAST: DVec2 = DVec2::new(1e-6, 1e-2);

pub(super) fn find(path: &CameraPath) -> Vec<PathWarning> {
    let short = shorter_than_frame(path);
    let warning = short.or_else(|| keys_within_frame(path));
    warning.into_iter().collect()
}

fn shorter_than_frame(path: &CameraPath) -> Option<PathWarning> {
    let (timeline, keys) = (path.timeline(), path.keys().len());
    let duration = timeline.end - timeline.start;
    (keys > 1 && duration * timeline.fps < LESS).then(|| PathWarning {
        frames: FrameRuns::of(0..timeline.frame_count()),
        kind: WarningKind::ShorterThanFrame {
            duration,
            fps: timeline.fps,
            keys,
        },
    })
}

/// The closest two keyframes within a frame between which the camera leaps.
fn keys_within_frame(path: &CameraPath) -> Option<PathWarning> {
    let timeline = path.timeline();
    let keys = path.keys();
    let cameras = path.key_cameras();
    if cameras.len() != keys.len() {
        return None;
    }
    let gaps: Vec<f64> = keys
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) * timeline.fps)
        .collect();
    // How far the camera moves and turns between each keyframe and the next.
    let moves: Vec<DVec2> = (cameras.windows(2))
        .map(|pair| {
            let [(_, from), (_, to)] = [pair[0], pair[1]];
            DVec2::new(
                from.position.distance(to.position),
                from.turn_to(&to).length(),
            )
        })
        .collect();
    let rate = |key: usize| Some(*moves.get(key)? / *gaps.get(key)?);
    let frame_of = |key: usize| {
        let frame = ((keys[key] - timeline.start) * timeline.fps).floor() as u32;
        frame.min(timeline.frame_count() - 1)
    };
    let leaps = |key: usize| {
        let beside = [key.checked_sub(1), Some(key + 1)].into_iter().flatten();
        let usual = beside
            .filter_map(rate)
            .reduce(DVec2::max)
            .unwrap_or(DVec2::ZERO);
        let size = cameras[key].1.position.abs().max_element();
        let least = LEAST * DVec2::new(size, 1.0);
        moves[key].cmpgt(least.max(FAST * usual * gaps[key])).any()
    };
    let is_missed = |&key: &usize| gaps[key] < LESS && !path.is_cut(frame_of(key)) && leaps(key);
    let missed = (0..gaps.len()).filter(is_missed);
    let key = missed.min_by(|&a, &b| gaps[a].total_cmp(&gaps[b]))?;
    let mut sorted = gaps.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    (sorted[sorted.len() / 2] >= BY_HAND).then(|| PathWarning {
        frames: FrameRuns::of([frame_of(key)]),
        kind: WarningKind::KeysWithinFrame {
            key,
            seconds: gaps[key] / timeline.fps,
            frame_seconds: 1.0 / timeline.fps,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{FPS, path};
    use super::*;
    use crate::camera::Interpolation::{self, CatmullRom, Hold, Linear};
    use glam::DVec3;

    /// Warnings of keys at these times in frames, each 1 m after the last.
    fn found(interpolation: Interpolation, frames: &[f64]) -> Vec<PathWarning> {
        let ahead = DVec3::new(0.0, 0.0, -1e3);
        let keys = frames.iter().enumerate().map(|(i, frame)| {
            let at = DVec3::new(i as f64, 0.0, 0.0);
            (frame / FPS, at, at + ahead)
        });
        find(&path(interpolation, &keys.collect::<Vec<_>>()))
    }

    #[test]
    fn a_path_within_a_frame_is_a_still() {
        for last in [0.3, 0.9] {
            let [warning] = &found(Linear, &[0.0, last])[..] else {
                panic!("{last}")
            };
            let WarningKind::ShorterThanFrame {
                duration, keys: 2, ..
            } = warning.kind
            else {
                panic!("{warning:?}")
            };
            assert!((duration - last / FPS).abs() < 1e-12);
        }
        assert_eq!(found(Linear, &[0.0]), []);
        assert_eq!(found(Linear, &[5.0, 6.0]), []);
    }

    #[test]
    fn keys_within_a_frame_are_found_among_others() {
        let [warning] = &found(CatmullRom, &[0.0, 24.0, 24.25, 48.0, 72.0])[..] else {
            panic!("a warning")
        };
        assert_eq!(warning.frames, FrameRuns::of([24]));
        let WarningKind::KeysWithinFrame {
            key: 1, seconds, ..
        } = warning.kind
        else {
            panic!("{warning:?}")
        };
        assert!((seconds - 0.25 / FPS).abs() < 1e-9);
        assert!(
            warning
                .to_string()
                .contains("keyframes[1] and keyframes[2] are 0.010 s apart")
        );
    }

    #[test]
    fn cuts_and_sampled_paths_are_intended() {
        assert_eq!(found(Hold, &[0.0, 24.0, 24.25, 48.0, 72.0]), []);
        // Of another program, at 60 frames per second.
        let sampled: Vec<f64> = (0..120).map(|i| 0.4 * f64::from(i)).collect();
        assert_eq!(found(Linear, &sampled), []);
        let rounded: Vec<f64> = (0..50)
            .map(|i| (f64::from(i) * 1e3 / FPS).round() * FPS / 1e3)
            .collect();
        assert_eq!(found(Linear, &rounded), []);
        assert_eq!(found(CatmullRom, &[0.0, 24.0, 25.0, 48.0, 72.0]), []);
        // Two keys close to each other, on a straight and at a constant speed.
        let key = |(frame, x): (f64, f64)| {
            let at = DVec3::new(x, 0.0, 0.0);
            (frame / FPS, at, at + DVec3::new(0.0, 0.0, -1e3))
        };
        let keys = [
            (0.0, 0.0),
            (24.0, 1.0),
            (24.5, 1.02),
            (48.0, 2.0),
            (72.0, 3.0),
        ];
        assert_eq!(find(&path(Linear, &keys.map(key))), []);
    }
}
