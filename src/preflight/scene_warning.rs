//! What preflight warns of in a scene: lights, materials and surfaces.

use super::warning::{Point, Short};
use glam::DVec3;
use std::fmt;
use thiserror::Error;

/// What may be wrong with a scene. Parts are named as in its files.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SceneWarning {
    /// Lights without intensity.
    #[error(
        "{}: intensity 0 gives no light; raise it, or leave the light out",
        Lights(lights)
    )]
    DarkLights {
        /// Their names.
        lights: Vec<String>,
    },
    /// No light, no ambient light and no background.
    #[error(
        "there are no lights that shine, and ambient and background are 0, so every frame is black; add `lights`, \
         or look at the scene with `--light camera`"
    )]
    Black,
    /// No light and no ambient light in a mode that does not gather light of the background.
    #[error(
        "there are no lights that shine, and ambient is 0: surfaces are black, but for what mirrors show; \
         add `lights`, or choose a montecarlo mode"
    )]
    BlackSurfaces,
    /// Nothing but ambient light in a mode that does not gather light.
    #[error(
        "there are no lights that shine: ambient light alone shows surfaces without shading; add `lights`"
    )]
    AmbientOnly,
    /// A light in a closed body that the camera never enters.
    #[error(
        "{} at {} is inside {body}, which is closed and opaque and which the camera never enters: it lights nothing \
         that is seen; move it out",
        light, Point(*position)
    )]
    SealedLight {
        /// Its name.
        light: String,
        /// Its position in world coordinates.
        position: DVec3,
        /// The object of the body.
        body: String,
    },
    /// Materials that reflect more light than falls on them.
    #[error(
        "material {}: more light is reflected than falls on it, {} times as much{}; lower diffuse or specular, or \
         raise shininess",
        materials[0], Short(*most), Others(materials.len() - 1, "materials")
    )]
    ReflectsTooMuch {
        /// Their names, that of the worst first.
        materials: Vec<String>,
        /// How much of vertical light the worst one reflects in its brightest channel.
        most: f64,
    },
    /// Shapes that are there twice.
    #[error(
        "{count} {} with another: {} of {} is also in {}, at {}; only the first is seen, leave the other out",
        if *count == 1 { "shape coincides" } else { "shapes coincide" },
        shape, objects[0], objects[1], Point(*position)
    )]
    Duplicates {
        /// How many have the vertices, or the centre and radius, of an earlier one.
        count: usize,
        /// What the first is: a triangle or a sphere.
        shape: &'static str,
        /// The objects of the first and of the shape that it repeats.
        objects: [String; 2],
        /// A point of it in world coordinates.
        position: DVec3,
    },
    /// Surfaces of different looks that overlap in one plane.
    #[error(
        "{count} {} in the same place (z-fighting): {} and {} at {}, seen in frame {frame}; rounding decides which \
         is seen, so move one of them",
        if *count == 1 { "pair of surfaces lies" } else { "pairs of surfaces lie" },
        objects[0], objects[1], Point(*position)
    )]
    Overlaps {
        /// Pairs of shapes that were found.
        count: usize,
        /// The objects of the first pair.
        objects: [String; 2],
        /// A point of the first pair in world coordinates.
        position: DVec3,
        /// A frame that shows the point.
        frame: u32,
    },
}

/// Displays the names of lights.
struct Lights<'a>(&'a [String]);

impl fmt::Display for Lights<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        /// Further ones are counted.
        const MAX_NAMED: usize = 8;
        let (named, others) = self.0.split_at(self.0.len().min(MAX_NAMED));
        write!(f, "{}{}", named.join(", "), Others(others.len(), "lights"))
    }
}

/// Displays how many more there are; nothing of none.
struct Others(usize, &'static str);

impl fmt::Display for Others {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.0 {
            0 => Ok(()),
            count => write!(f, " ({count} other {} too)", self.1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_are_in_one_line() {
        let dark = SceneWarning::DarkLights {
            lights: (0..10).map(|i| format!("lights[{i}]")).collect(),
        };
        assert_eq!(
            dark.to_string(),
            "lights[0], lights[1], lights[2], lights[3], lights[4], lights[5], lights[6], lights[7] (2 other lights \
             too): intensity 0 gives no light; raise it, or leave the light out"
        );
        let sealed = SceneWarning::SealedLight {
            light: "lights[3]".to_owned(),
            position: DVec3::new(1.0, 0.12345, -1e-6),
            body: "objects[2]".to_owned(),
        };
        let text = "lights[3] at (1, 0.123, -1.0e-6) is inside objects[2], which";
        assert!(sealed.to_string().starts_with(text), "{sealed}");
    }
}
