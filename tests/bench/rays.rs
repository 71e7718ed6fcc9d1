//! How fast rays are answered on one thread: `cargo bench --bench rays -- FOLDER [EMBREE_OUTPUT]`.
//!
//! Reads every scene of the folder: `NAME.tri` (an i32 count, then nine f32 for each triangle) and
//! its ray sets `NAME.primary`, `.shadow`, `.diffuse1`, `.diffuse2`, `.shadow2` (a count, then
//! origin, direction, t_max and a spare for each ray; all little-endian). Rates are millions of rays
//! per second, the best of six runs: one by one, and in packets of sixteen. The check sum is the sum
//! of all distances, or the number of occluded rays: any other tracer must find the same.
//!
//! The second file is what a program that times Embree on the same files printed: for each scene a
//! line `embree PREFIX triangles=N robust=1 build=MS ms`, then for each set a line with its name
//! and `| WIDTH RATE M/s (SUM)` for each packet width. It adds what they are to each other, and the
//! benchmark fails if the sums differ by more than rounding.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark prints or fails"
)]

use flythrough::accel::{Bvh, QueryState, RayPacket};
use flythrough::math::Ray;
use flythrough::simd::{Kernel, PACKET_WIDTH};
use glam::Vec3;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

const RUNS: usize = 6;
const SETS: [&str; 5] = ["primary", "shadow", "diffuse1", "diffuse2", "shadow2"];

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|a| !a.starts_with('-'));
    let Some(folder) = arguments.next() else {
        println!("no folder of ray sets given: nothing to measure");
        return;
    };
    let embree = arguments.next().map_or(BTreeMap::new(), |file| {
        read_embree(&std::fs::read_to_string(file).unwrap())
    });
    let mut scenes: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "tri"))
        .collect();
    scenes.sort();
    // One thread builds, too: nothing else would be a fair comparison.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.unwrap().install(|| {
        println!(
            "| scene, rays | one by one, M/s | packets, M/s | Embree, M/s | best / Embree | sum |"
        );
        println!("|---|---|---|---|---|---|");
        for scene in scenes {
            measure(&scene, &embree);
        }
    });
}

/// Rates and sums by scene and set; milliseconds of the build by scene and "build".
type Embree = BTreeMap<(String, String), (f64, f64)>;

fn read_embree(text: &str) -> Embree {
    let mut results = Embree::new();
    let mut scene = None;
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        if let ["embree", name, _, robust, build, ..] = words[..] {
            scene = (robust == "robust=1").then(|| name.to_string());
            let build = build.strip_prefix("build=").unwrap().parse().unwrap();
            if let Some(scene) = &scene {
                results.insert((scene.clone(), "build".into()), (build, 0.0));
            }
        } else if let Some(scene) = &scene {
            for width in line.split('|').skip(1) {
                let fields: Vec<&str> = width.split_whitespace().collect();
                let rate: f64 = fields[1].parse().unwrap();
                let sum = fields[3].trim_matches(['(', ')']).parse().unwrap();
                let key = (scene.clone(), words[0].to_string());
                let best = results.entry(key).or_insert((rate, sum));
                best.0 = best.0.max(rate);
            }
        }
    }
    results
}

fn measure(scene: &Path, embree: &Embree) {
    let name = scene.file_stem().unwrap().to_str().unwrap().to_string();
    let triangles: Vec<[Vec3; 3]> = records::<9>(scene)
        .map(|c| [0, 3, 6].map(|i| Vec3::from_slice(&c[i..])))
        .collect();
    let mut bvh = Bvh::new(&[], vec![], Kernel::default());
    let build = 1e3 * best(|| bvh = Bvh::new(&triangles, vec![], Kernel::default()));
    assert_eq!(bvh.validate(), Ok(()));
    let bytes = bvh.memory() as f64 / triangles.len() as f64;
    let theirs = embree.get(&(name.clone(), "build".into()));
    println!(
        "| {name}: {} triangles, {bytes:.0} bytes each, build {build:.0} ms | | | {} | {} | |",
        triangles.len(),
        theirs.map_or(String::new(), |(ms, _)| format!("{ms:.0} ms")),
        theirs.map_or(String::new(), |(ms, _)| format!("{:.2}", ms / build)),
    );
    for set in SETS {
        let rays: Vec<Ray> = records::<8>(&scene.with_extension(set))
            .map(|r| Ray {
                t_max: r[6],
                ..Ray::new(Vec3::from_slice(&r), Vec3::from_slice(&r[3..]))
            })
            .collect();
        let (single, sum) = rate(&rays, |rays, query_state| {
            one_by_one(&bvh, set, rays, query_state)
        });
        let (packets, same) = rate(&rays, |rays, query_state| {
            in_packets(&bvh, set, rays, query_state)
        });
        assert_eq!(sum, same, "packets find what single rays find");
        let theirs = embree.get(&(name.clone(), set.to_string()));
        if let Some((_, their_sum)) = theirs {
            assert!((sum - their_sum).abs() <= 2e-7 * sum, "{sum} {their_sum}");
        }
        println!(
            "| {name}, {set} | {single:.2} | {packets:.2} | {} | {} | {sum:.0} |",
            theirs.map_or(String::new(), |(rate, _)| format!("{rate:.2}")),
            theirs.map_or(String::new(), |(rate, _)| {
                format!("{:.2}", single.max(packets) / rate)
            }),
        );
    }
}

fn is_shadow(set: &str) -> bool {
    set.starts_with("shadow")
}

fn one_by_one(bvh: &Bvh, set: &str, rays: &[Ray], query_state: &mut QueryState) -> f64 {
    let mut sum = 0.0;
    for ray in rays {
        if is_shadow(set) {
            sum += f64::from(u8::from(bvh.occluded(ray, query_state)));
        } else if let Some(hit) = bvh.closest(ray, query_state) {
            sum += hit.t;
        }
    }
    sum
}

fn in_packets(bvh: &Bvh, set: &str, rays: &[Ray], query_state: &mut QueryState) -> f64 {
    let mut sum = 0.0;
    for rays in rays.chunks(PACKET_WIDTH) {
        if is_shadow(set) {
            let occluded = bvh.occluded_coherent(&RayPacket::new(rays), query_state);
            sum += f64::from(occluded.count_ones());
        } else {
            let mut hits = [None; PACKET_WIDTH];
            bvh.closest_coherent(rays, &mut hits[..rays.len()], query_state);
            for hit in hits.iter().flatten() {
                sum += hit.t;
            }
        }
    }
    sum
}

/// Millions of rays per second, and the sum.
fn rate(rays: &[Ray], mut work: impl FnMut(&[Ray], &mut QueryState) -> f64) -> (f64, f64) {
    let mut query_state = QueryState::default();
    let mut sum = 0.0;
    let seconds = best(|| sum = work(rays, &mut query_state));
    (rays.len() as f64 / seconds / 1e6, sum)
}

/// The least seconds that `work` took.
fn best(mut work: impl FnMut()) -> f64 {
    (0..RUNS).fold(f64::INFINITY, |least, _| {
        let start = Instant::now();
        work();
        least.min(start.elapsed().as_secs_f64())
    })
}

fn records<const N: usize>(file: &Path) -> impl Iterator<Item = [f32; N]> {
    let bytes = std::fs::read(file).unwrap();
    let words = bytes.as_chunks::<4>().0;
    let count = i32::from_le_bytes(words[0]) as usize;
    let numbers: Vec<f32> = words[1..].iter().map(|w| f32::from_le_bytes(*w)).collect();
    assert_eq!(numbers.len(), count * N, "{}", file.display());
    (0..count).map(move |i| std::array::from_fn(|k| numbers[i * N + k]))
}
