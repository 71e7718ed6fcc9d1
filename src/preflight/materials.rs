//! Materials that reflect more light than falls on them.

use super::SceneWarning;
use crate::material::Material;
use crate::scene::{Scene, SceneNames};
use glam::{DVec3, Vec3};

/// The least excess that counts. A white wall with a faint highlight exceeds 1 as well, and nobody sees it.
const MIN_EXCESS: f64 = 0.05;

pub(super) fn find(scene: &Scene, names: &SceneNames) -> Vec<SceneWarning> {
    let too_much = |id: usize| {
        let material = &scene.materials()[id];
        let reflects = |texture: DVec3| reflectance(material, texture).max_element();
        // A texture is at most white; only where that is too much its mean counts.
        let is_too_much = |reflectance: f64| reflectance > 1.0 + MIN_EXCESS;
        let white = reflects(DVec3::ONE);
        let texture = material.texture.filter(|_| is_too_much(white));
        let reflectance = texture.map_or(white, |id| reflects(scene.textures()[id].mean()));
        is_too_much(reflectance).then_some((id, reflectance))
    };
    let used = scene.used_materials().into_iter();
    let mut sorted: Vec<(usize, f64)> = used.filter_map(too_much).collect();
    sorted.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut materials: Vec<String> = sorted.iter().map(|(id, _)| names.material(*id)).collect();
    // Copies with mirrors of their own.
    materials.dedup();
    let warning = sorted
        .first()
        .map(|&(_, most)| SceneWarning::ReflectsTooMuch { materials, most });
    warning.into_iter().collect()
}

/// The fraction of light along the normal that a material reflects over the hemisphere, in each channel: of a highlight
/// of weight ks and exponent n it is ks / pi times the integral of cos^(n + 1), 2 ks / (n + 2). The mirror takes its
/// part from the base layer.
fn reflectance(material: &Material, texture: DVec3) -> DVec3 {
    let [diffuse, specular, mirror] =
        [material.diffuse, material.specular, material.reflective].map(Vec3::as_dvec3);
    let highlight = specular * (2.0 / (f64::from(material.shininess) + 2.0));
    (diffuse * texture + highlight) * (1.0 - mirror) + mirror
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::hall;
    use super::*;
    use crate::material::FeatureMask;
    use crate::scene::{MeshMaterial, SceneBuilder, SourceMesh};
    use crate::texture::Texture;
    use glam::Vec2;

    /// The reflectance that is warned of, of a used material in a scene with a grey texture.
    fn found(material: Material) -> Option<f64> {
        let unused = Material::lambert(Vec3::splat(9.0));
        let builder = SceneBuilder {
            materials: vec![unused, material],
            textures: Texture::new(1, 2, vec![[0; 3], [255; 3]])
                .into_iter()
                .collect(),
            meshes: vec![SourceMesh {
                material: MeshMaterial::Uniform(1),
                ..hall()
            }],
            ..SceneBuilder::default()
        };
        let names = SceneNames {
            materials: vec!["\"unused\"".to_owned(), "\"wall\"".to_owned()],
            ..SceneNames::default()
        };
        match &find(&builder.build().0, &names)[..] {
            [] => None,
            [warning @ SceneWarning::ReflectsTooMuch { materials, most }] => {
                assert_eq!(materials, &["\"wall\""]);
                assert!(
                    warning
                        .to_string()
                        .starts_with("material \"wall\": more light")
                );
                Some(*most)
            }
            other => panic!("{other:?}"),
        }
    }

    fn material(diffuse: f32, specular: f32, shininess: f32, reflective: f32) -> Material {
        Material {
            specular: Vec3::splat(specular),
            shininess,
            reflective: Vec3::splat(reflective),
            ..Material::lambert(Vec3::new(0.1, diffuse, 0.1))
        }
    }

    #[test]
    fn what_is_reflected_is_compared_with_what_falls_on_it() {
        for conserving in [
            material(1.0, 0.0, 0.0, 0.0),
            material(0.9, 0.0, 0.0, 0.9),
            material(0.8, 0.4, 40.0, 0.0),
            material(1.0, 0.5, 250.0, 0.0),
            material(0.0, 1.0, 0.0, 1.0),
        ] {
            assert_eq!(found(conserving), None);
        }
        let near = |found: Option<f64>, expected: f64| {
            assert!(
                (found.expect("a warning") - expected).abs() < 1e-6,
                "{found:?}"
            );
        };
        near(found(material(0.9, 1.0, 0.0, 0.0)), 1.9);
        near(found(material(0.9, 4.0, 6.0, 0.0)), 1.9);
        near(found(material(0.9, 4.0, 6.0, 0.5)), 1.45);
    }

    #[test]
    fn textures_count_by_their_mean() {
        let textured = |specular| Material {
            texture: Some(0),
            ..material(1.0, specular, 0.0, 0.0)
        };
        assert_eq!(found(textured(0.5)), None);
        assert!((found(textured(0.7)).expect("a warning") - 1.2).abs() < 1e-6);
    }

    /// The closed form against an integral over the hemisphere of the material's own reflection.
    #[test]
    fn the_reflectance_is_that_of_the_reflection_model() {
        let material = material(0.3, 0.8, 3.0, 0.25);
        let bsdf = material.bsdf::<FeatureMask<15>>(Vec2::ZERO, [Vec2::ZERO; 2], &[]);
        let steps = 2000;
        let angle = |i: usize| (i as f64 + 0.5) / f64::from(steps) * std::f64::consts::FRAC_PI_2;
        let sum: f64 = (0..steps as usize)
            .map(|i| {
                let (sin, cos) = angle(i).sin_cos();
                let view = Vec3::new(sin as f32, 0.0, cos as f32);
                let local = bsdf.eval_cos::<FeatureMask<15>>(Vec3::Z, Vec3::Z, view).y;
                2.0 * f64::from(local) * cos * sin
            })
            .sum();
        let base = sum * std::f64::consts::FRAC_PI_2 / f64::from(steps);
        let expected = reflectance(&material, DVec3::ONE).y;
        let base = 0.75 * base;
        assert!((base + 0.25 - expected).abs() < 1e-4, "{base} {expected}");
    }
}
