//! SVG rendered to pixels, with the program's own font.

use crate::text::visible;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Error, Options, Tree};
use std::sync::Arc;

/// Renders the text of an SVG file, one pixel for each unit of its size. An error if it is not valid or too large.
///
/// The only font is `sans-serif`, so that the result does not depend on the machine's fonts.
pub(super) fn pixels(svg: &str) -> Result<Pixmap, Error> {
    let mut options = Options::default();
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(notosans::REGULAR_TTF.to_vec());
    fonts.set_sans_serif_family("Noto Sans");
    let tree = Tree::from_str(svg, &options)?;
    let size = tree.size().to_int_size();
    let pixels = Pixmap::new(size.width(), size.height());
    let mut pixels = pixels.ok_or(Error::InvalidSize)?;
    resvg::render(&tree, Transform::default(), &mut pixels.as_mut());
    Ok(pixels)
}

/// Escapes a text for SVG; what XML does not allow becomes visible.
pub(super) fn escaped(text: &str) -> String {
    let text = visible(text).replace('&', "&amp;");
    text.replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(content: &str) -> Pixmap {
        let start = "<svg xmlns='http://www.w3.org/2000/svg' width='80' height='30'>";
        pixels(&format!("{start}{content}</svg>")).expect("drawn")
    }

    #[test]
    fn shapes_are_where_they_should_be() {
        let drawn = drawn("<rect x='2' y='1' width='3' height='4' fill='#0af'/>");
        assert_eq!((drawn.width(), drawn.height()), (80, 30));
        for y in 0..30 {
            for x in 0..80 {
                let pixel = drawn.pixel(x, y).expect("inside");
                let color = [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()];
                let is_inside = (2..5).contains(&x) && (1..5).contains(&y);
                let expected = if is_inside {
                    [0, 170, 255, 255]
                } else {
                    [0; 4]
                };
                assert_eq!(color, expected, "{x} {y}");
            }
        }
    }

    #[test]
    fn any_text_can_be_written() {
        let text = |text: &str| {
            let text = escaped(text);
            drawn(&format!(
                "<text y='20' font-family='sans-serif'>{text}</text>"
            ))
        };
        assert_eq!(text("a\u{1}\u{ffff}<&]]>"), text(r"a\u{1}\u{ffff}<&]]>"));
        for (one, other) in [("<", " "), ("&", "<"), ("a > b", "a b"), ("ä", "a")] {
            assert_ne!(text(one), text(other), "{one} {other}");
        }
    }

    #[test]
    fn no_text_of_a_picture_is_an_error() {
        assert!(pixels("frame").is_err());
    }
}
