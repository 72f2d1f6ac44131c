//! Text that goes into SVG and HTML.

use super::palette::Rgb;

/// The text with the five characters escaped that mean something in markup.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            // HTML knows no such characters, not even escaped.
            control if control.is_control() && control != '\n' => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}

/// `#rrggbb`
pub(super) fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A number with that many decimals; a dash for what is no number.
pub(super) fn number(value: f32, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { String::from("–") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_a_name_stays_text() {
        assert_eq!(
            escape("<b onload='x'>\"&\u{7}"),
            "&lt;b onload=&#39;x&#39;&gt;&quot;&amp;\u{fffd}"
        );
    }

    #[test]
    fn nan_is_a_dash() {
        assert_eq!(number(f32::NAN, 3), "–");
        assert_eq!(number(0.5, 3), "0.500");
    }
}
