//! Text that others wrote, as it may be shown: on a terminal, in a document, in a picture.

use std::fmt::{Display, Write};

/// The text with escapes, as in `\n` and `\u{1b}`, in place of all characters that do not show themselves.
///
/// These are control characters, line and paragraph separators, controls of the writing direction, other invisible
/// format characters, and noncharacters, which XML does not allow. So no name can begin a line of its own, command a
/// terminal or reorder what stands beside it.
pub fn visible(text: impl Display) -> String {
    let mut shown = String::new();
    for letter in text.to_string().chars() {
        let written = match shows_itself(letter) {
            true => write!(shown, "{letter}"),
            false => write!(shown, "{}", letter.escape_default()),
        };
        written.expect("a string can be written to");
    }
    shown
}

/// The joiners U+200C and U+200D do: Persian, Hindi and emoji are written with them.
fn shows_itself(letter: char) -> bool {
    let is_format = matches!(letter,
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}' | '\u{200e}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
        | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}');
    let is_noncharacter =
        matches!(letter, '\u{fdd0}'..='\u{fdef}') || u32::from(letter) & 0xfffe == 0xfffe;
    !letter.is_control() && !is_format && !is_noncharacter
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_of_all_scripts_stay() {
        for text in [
            "",
            "it's 100 % \"a\\b\" $(c) `d`",
            "é e\u{301} 日本 ی\u{200c}ک 👩\u{200d}🚀 \u{fffd}",
        ] {
            assert_eq!(visible(text), text);
        }
    }

    #[test]
    fn what_does_not_show_itself_is_escaped() {
        let text =
            "a\x1b[31m\r\n\t\x07\x7f\u{9b}\u{85}\u{202e}\u{2066}\u{200f}\u{2028}\u{feff}\u{ffff}é";
        let shown = r"a\u{1b}[31m\r\n\t\u{7}\u{7f}\u{9b}\u{85}\u{202e}\u{2066}\u{200f}\u{2028}\u{feff}\u{ffff}é";
        assert_eq!(visible(text), shown);
    }

    /// Of all characters, none of those that Rust calls controls is left, nor any that is white space but a space of
    /// some width.
    #[test]
    fn no_control_is_left() {
        for letter in char::MIN..=char::MAX {
            let shown = visible(letter);
            let is_blank = shown.chars().any(|c| {
                c.is_control() || (c.is_whitespace() && letter.escape_debug().count() == 2)
            });
            assert!(!is_blank && !shown.is_empty(), "{letter:?}");
        }
    }
}
