//! OBJ models (Wavefront, "Advanced Visualizer Manual", appendix B1), parsed by tobj.

use super::error::InputError;
use super::files::{InputFiles, relative_to};
use super::mtl::{Libraries, ObjMaterial};
use super::obj_check::ObjCheck;
use super::obj_signature::{ObjStatements, check_bytes};
use super::statements::{Statements, text};
use crate::geometry::{fan, triangulate};
use glam::{DVec2, DVec3, Vec2};
use std::cell::RefCell;
use std::path::Path;

/// A model in its own coordinates.
#[derive(Debug)]
pub(super) struct ObjModel {
    pub(super) parts: Vec<ObjPart>,
    pub(super) materials: Vec<ObjMaterial>,
    /// About what is not supported or looks wrong.
    pub(super) warnings: Vec<String>,
}

/// The triangles of one object with one material.
#[derive(Debug)]
pub(super) struct ObjPart {
    /// Of its object or group.
    pub(super) name: String,
    pub(super) positions: Vec<DVec3>,
    /// Empty, or one for each position; not normalized.
    pub(super) normals: Vec<DVec3>,
    /// Empty, or one for each position.
    pub(super) uvs: Vec<Vec2>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// An index into the model's materials.
    pub(super) material: Option<usize>,
}

/// Reads an OBJ file. Its material library is only read if `with_materials`.
pub(super) fn load(
    file: &Path,
    bytes: &[u8],
    with_materials: bool,
    files: &mut InputFiles,
) -> Result<ObjModel, InputError> {
    let options = tobj::LoadOptions {
        triangulate: false,
        single_index: true,
        ignore_points: true,
        ignore_lines: true,
    };
    check_bytes(file, bytes)?;
    let text = text(file, bytes)?;
    let mut check = ObjCheck::default();
    let mut kinds = ObjStatements::default();
    let mut statements = Statements::new(&text, |keyword, rest, out| {
        kinds.add(keyword);
        check.prepare(keyword, rest, out)
    });
    // tobj ignores a library that cannot be loaded; this keeps the error.
    let state = RefCell::new((files, Libraries::default(), None));
    let loaded = tobj::load_obj_buf(&mut statements, &options, |name| {
        let (files, libraries, failure) = &mut *state.borrow_mut();
        if !with_materials {
            return Ok(Default::default());
        }
        let library = relative_to(file, &name.to_string_lossy());
        let loaded = libraries.load(&library, file, files);
        loaded.map_err(|error| {
            failure.get_or_insert(error);
            tobj::LoadError::GenericFailure
        })
    });
    let (_, libraries, failure) = state.into_inner();
    if let Some(failure) = failure {
        return Err(failure);
    }
    let (models, _) = match loaded {
        Ok(loaded) => loaded,
        Err(error) => return Err(statements.fault(file, error)),
    };
    kinds.check(file)?;
    let mut crossed = 0;
    let models = models.into_iter();
    let parts: Vec<_> = models.map(|m| part(m, &mut crossed)).collect();
    let mut warnings = libraries.warnings;
    warnings.extend(check.unused.warning(file));
    let mut warn = |message: String| warnings.push(format!("{}: {message}", file.display()));
    if parts.iter().all(|part| part.triangles.is_empty()) {
        warn("has no faces, so it is invisible".to_owned());
    }
    if crossed > 0 {
        warn(format!(
            "{crossed} faces cross themselves, or are concave and of very many vertices, and are cut \
             into fans; they may look wrong"
        ));
    }
    let bare = parts.iter().filter(|part| part.material.is_none());
    let bare: usize = bare.map(|part| part.triangles.len()).sum();
    if with_materials && bare > 0 {
        warn(format!(
            "{bare} triangles have no material of its libraries and are grey; give the object a \
             `material`"
        ));
    }
    Ok(ObjModel {
        parts,
        materials: libraries.materials,
        warnings,
    })
}

/// Triangulates a mesh. Counts the faces that are cut into fans, as they may be `crossed`: intersect themselves.
fn part(model: tobj::Model, crossed: &mut usize) -> ObjPart {
    let mesh = model.mesh;
    let positions = triples(&mesh.positions);
    let (uvs, _) = mesh.texcoords.as_chunks();
    let mut triangles = Vec::new();
    let mut rest = &mesh.indices[..];
    let mut arities = mesh.face_arities.iter();
    while !rest.is_empty() {
        // tobj gives no arities if all faces are triangles.
        let arity = arities.next().map_or(3, |&arity| arity as usize);
        let (face, others) = rest.split_at(arity);
        let vertices: Vec<DVec3> = face.iter().map(|&i| positions[i as usize]).collect();
        let cut = triangulate(&vertices).unwrap_or_else(|| {
            *crossed += 1;
            fan(arity)
        });
        triangles.extend(cut.into_iter().map(|vertices| vertices.map(|i| face[i])));
        rest = others;
    }
    ObjPart {
        name: model.name,
        normals: triples(&mesh.normals),
        uvs: uvs
            .iter()
            .map(|uv| DVec2::from_array(*uv).as_vec2())
            .collect(),
        positions,
        triangles,
        material: mesh.material_id,
    }
}

fn triples(numbers: &[f64]) -> Vec<DVec3> {
    let (triples, _) = numbers.as_chunks();
    triples.iter().copied().map(DVec3::from_array).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn load_text(text: &str) -> Result<ObjModel, InputError> {
        load(
            Path::new("x.obj"),
            text.as_bytes(),
            true,
            &mut InputFiles::default(),
        )
    }

    #[test]
    fn polygons_negative_indices_and_normals() {
        let model = load_text(
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\nvn 0 0 2\n\
             f -5//1 -4//1 -3//1 -2//1 -1//1\n",
        )
        .expect("a pentagon");
        let part = &model.parts[0];
        assert_eq!(part.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(part.positions[4], DVec3::new(-1.0, 0.5, 0.0));
        assert_eq!(part.normals, [DVec3::Z * 2.0; 5]);
        assert!(part.uvs.is_empty());
        assert_eq!(model.warnings.len(), 1);
        assert!(model.warnings[0].contains("3 triangles have no material"));
    }

    #[test]
    fn comments_end_with_their_line() {
        let model = load_text("# a\\\nv 0 0 0 # b\\\nv 9 0 \\\n0\nv 0 9 0\nf 1 2 3\n");
        let vertices = model.expect("a triangle").parts[0].positions.clone();
        assert_eq!(vertices, [DVec3::ZERO, 9.0 * DVec3::X, 9.0 * DVec3::Y]);
    }

    #[test]
    fn the_line_of_a_fault() {
        let triangle = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
        for (text, expected) in [
            ("v 0 0 0\n\nv 1 x 0\n", "x.obj:3: `v`: x is not a number"),
            ("v 0 0 0\nv 1 NaN 0\n", "x.obj:2: `v`: NaN is not a number"),
            ("v 0 0 0\nv 1 -1e400 0\n", "x.obj:2: `v`: -1e400 is not"),
            (
                "v 0 0 0\nv 1 0",
                "x.obj:2: `v` has 2 numbers; it takes three",
            ),
            ("v 0 0 0 0\n", "x.obj:1: `v`: its weight 0 takes it beyond"),
            ("vt\n", "x.obj:1: `vt` has 0 numbers; it takes one to three"),
            (
                "vn 0 0 1 1\n",
                "x.obj:1: `vn` has 4 numbers; it takes three",
            ),
            ("usemtl\n", "x.obj:1: `usemtl` has no name after it"),
            ("\nv 0 \\\n0 0\n \\\n\nv 1\n", "x.obj:6: `v` has 1"),
            ("\nv\0\n", "x.obj:2: contains a zero byte"),
        ] {
            let error = load_text(text).expect_err(text).to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        for (vertices, expected) in [
            ("1 2 9", "9 names `v` number 9; 3 stand before it"),
            ("1 2 -4", "-4 names `v` number -4; 3 stand"),
            ("0 1 2", "0 names `v` number 0; 3 stand"),
            ("1/1 2/1 3/1", "1/1 names `vt` number 1; 0 stand"),
            ("1//-1 2 3", "1//-1 names `vn` number -1; 0 stand"),
            (
                "1 2 99999999999999999999",
                "99999999999999999999 names `v` number 99999999999999999999; 3 stand",
            ),
            ("1 2 3/", ""),
            ("1 2 /3", "/3 is not v, v/vt, v//vn or v/vt/vn"),
            ("1/2/3/4 2 3", "1/2/3/4 names `vt` number 2; 0 stand"),
            ("1/// 2 3", "1/// is not v"),
            ("1 2 3 four", "four names `v` number four"),
            ("1 2 3 # a comment", ""),
        ] {
            let error = load_text(&format!("{triangle}f {vertices}\n")).map(|_| ());
            let error = error.map_or_else(|error| error.to_string(), |()| String::new());
            let expected = match expected {
                "" => String::new(),
                expected => format!("x.obj:4: `f`: {expected}"),
            };
            assert_eq!(error.is_empty(), expected.is_empty(), "{error}");
            assert!(error.starts_with(&expected), "{error}");
        }
    }

    #[test]
    fn what_is_not_used_is_counted() {
        let model = load_text(
            "v 0 0 0 1 0 0\nv 1 0 0 0 nan 0\nv 1 1 0\nvt 0 0\nl 1 2 3 1\np 1\nf 1 2\nF 1 2 3\n\
             s 1\nf 1/1 2 3\nv 9 9 9\n",
        )
        .expect("a face");
        assert!(model.parts[0].uvs.is_empty());
        assert_eq!(model.parts[0].triangles, [[0, 1, 2]]);
        assert_eq!(
            model.warnings,
            [
                "x.obj: not used: 1 `F`, 1 `f` of fewer than three vertices, 1 `f` with texture \
                 coordinates or normals at some vertices only: these, 1 `l`, 1 `p`, 2 colours of `v`",
                "x.obj: 1 triangles have no material of its libraries and are grey; give the \
                 object a `material`",
            ]
        );
        let model = load_text("v 0 0 0\r\nl 1 1\r\n").expect("a line");
        let last = model.warnings.last().map(String::as_str);
        assert_eq!(last, Some("x.obj: has no faces, so it is invisible"));
    }

    #[test]
    fn what_is_no_obj_file_is_refused() {
        let noise: String = (0..400)
            .map(|i| char::from(b'!' + (i * i % 89) as u8))
            .collect();
        for text in [
            "",
            "# empty\n",
            "v 0 0 0\nv 1 0 0\n",
            "solid ascii\nfacet normal 0 0 1\n",
            "Scene(\n    objects: [],\n)\n",
            "It was the best of times,\nit was the worst of times,\n",
            "newmtl a\nKd 1 1 1\n",
            &noise,
        ] {
            let error = load_text(text).map(|_| ()).expect_err(text).to_string();
            assert!(error.starts_with("x.obj: is no OBJ model: "), "{error}");
        }
    }

    #[test]
    fn odd_spelling_changes_nothing() {
        let plain = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0.5 0\nf 1/1 2/1 3/1\n";
        let odd = [
            plain.replace('\n', "\r\n"),
            format!("\u{feff}{plain}"),
            format!("# C:\\models\\\n{plain}"),
            plain.replace(' ', "\t "),
            plain
                .replace("1 0 0\n", "1 0 0 1 # weight\n")
                .replace("\nf", "\n  f"),
            plain.replace("2/1 ", "\\\n 2/1  \\\n"),
            plain
                .replace("f 1/1 2/1 3/1\n", "f -3/-1 -2/1/ 3/1// \n")
                .replace("//", "/"),
            plain.replace("0.5 0\n", ".5").replace(".5f", ".5\nf"),
            plain.replace("0.5 0\n", "5e-1 +0 7\n"),
            plain.trim_end().to_owned(),
        ];
        for text in odd {
            let model = load_text(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
            let [part] = &model.parts[..] else {
                panic!("{text}")
            };
            assert_eq!(
                part.positions,
                [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0)]
            );
            assert_eq!(part.uvs, [Vec2::new(0.5, 0.0); 3]);
            assert_eq!(model.warnings.len(), 1, "{:?}", model.warnings);
        }
    }

    #[test]
    fn concave_and_crossed_faces() {
        let arrow = load_text("v 0 0 0\nv 2 -1 0\nv 1 0 0\nv 2 1 0\nf 2 3 4 1\n").expect("a face");
        assert_eq!(arrow.parts[0].triangles, [[1, 2, 3], [0, 1, 3]]);
        let tie = load_text("v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 3 0\nf 1 2 3 4\n").expect("a face");
        assert_eq!(tie.parts[0].triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(tie.warnings[0].starts_with("x.obj: 1 faces cross themselves"));
    }

    #[test]
    fn faces_with_and_without_normals_in_one_object() {
        let model =
            load_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 3\nf 3 2 1\n")
                .expect("two groups");
        let counts = model
            .parts
            .iter()
            .map(|p| (p.triangles.len(), p.normals.len()));
        assert_eq!(counts.collect::<Vec<_>>(), [(1, 3), (2, 0)]);
    }

    #[test]
    fn material_library() {
        let library = tempfile::tempdir().expect("a folder");
        let mtl = "newmtl a\nKd 0.5 0.25 0\nKs 1 1 1\nNs 20\nillum 2\nmap_Kd sub\\t.png\n\
                   newmtl b\nKs 0.5 0.5 0.5\nillum 3\nKe 1 0 9\nTf 1 0 0\n";
        std::fs::write(library.path().join("m.mtl"), mtl).expect("writable");
        let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl b\nf 1 2 3\nusemtl a\nf 3 2 1\n";
        let file = library.path().join("x.obj");
        let model = load(&file, obj.as_bytes(), true, &mut InputFiles::default()).expect("loads");
        let used: Vec<_> = model.parts.iter().map(|p| p.material).collect();
        assert_eq!(used, [Some(1), Some(0)]);
        let [a, b] = &model.materials[..] else {
            panic!("two materials")
        };
        assert_eq!((a.diffuse, a.shininess), (Vec3::new(0.5, 0.25, 0.0), 20.0));
        assert_eq!((a.specular, a.reflective), (Vec3::ONE, Vec3::ZERO));
        let texture = a.texture.as_ref().map(|t| t.file.clone());
        assert_eq!(texture, Some(library.path().join("sub/t.png")));
        assert_eq!((b.diffuse, b.reflective), (Vec3::ONE, Vec3::splat(0.5)));
        assert!(model.warnings.len() == 1 && model.warnings[0].ends_with("not used: 1 `Tf`"));
        assert_eq!(
            (a.emission, b.emission),
            (Vec3::ZERO, Vec3::new(1.0, 0.0, 9.0))
        );
        let missing = load(&file, b"mtllib n.mtl\n", true, &mut InputFiles::default());
        assert!(missing.is_err_and(|e| e.to_string().contains("n.mtl")));
        assert!(load(&file, b"mtllib n.mtl\n", false, &mut InputFiles::default()).is_ok());
    }
}
