//! One colour per objective, everywhere: sheet, dome, plots, table.
//!
//! Blue, vermilion, green and purple after Okabe and Ito (2008), darkened until white text on them
//! has a contrast of 4.5 to 1. Letters and names stand beside them: colour never says it alone.

use vantage_core::Objective;

/// Red, green, blue.
pub(super) type Rgb = [u8; 3];

/// Text and axes.
pub(super) const INK: Rgb = [0x1b, 0x24, 0x30];
/// Lesser text.
pub(super) const MUTED: Rgb = [0x5b, 0x66, 0x75];
/// Grid lines.
pub(super) const GRID: Rgb = [0xe2, 0xe4, 0xe8];
/// A view that no single objective chose.
pub(super) const NO_OBJECTIVE: Rgb = [0x5f, 0x6b, 0x7c];
/// Curves to compare with, in the order in which they come.
pub(super) const BASELINES: [Rgb; 4] =
    [[0x8b, 0x95, 0xa5], [0xb4, 0x7b, 0x00], [0x3f, 0x9f, 0x9b], [0x7a, 0x5c, 0x3e]];

/// The colour of an objective, or of none.
pub(super) const fn colour(objective: Option<Objective>) -> Rgb {
    match objective {
        Some(Objective::Coverage) => [0x00, 0x6b, 0xa8],
        Some(Objective::Geometry) => [0xbd, 0x4f, 0x00],
        Some(Objective::Diversity) => [0x00, 0x7d, 0x5c],
        Some(Objective::Texture) => [0xa2, 0x40, 0x87],
        None => NO_OBJECTIVE,
    }
}

/// The objective of that name, as records have it; none for any other word.
pub(super) fn objective(name: Option<&str>) -> Option<Objective> {
    Objective::ALL.into_iter().find(|objective| Some(objective.name()) == name)
}

/// The CSS class of an objective: its name, or `plain`.
pub(super) fn class(objective: Option<Objective>) -> &'static str {
    objective.map_or("plain", Objective::name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// WCAG 2.1: relative luminance, and the contrast of white on it.
    fn contrast_with_white(colour: Rgb) -> f64 {
        let [r, g, b] = colour.map(|channel| {
            let c = f64::from(channel) / 255.0;
            if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        1.05 / (0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05)
    }

    #[test]
    fn white_text_is_readable_on_every_objective() {
        for objective in Objective::ALL.map(Some).into_iter().chain([None]) {
            assert!(contrast_with_white(colour(objective)) >= 4.5, "{objective:?}");
        }
    }

    #[test]
    fn names_lead_to_objectives() {
        assert_eq!(objective(Some("texture")), Some(Objective::Texture));
        assert_eq!(objective(Some("beauty")), None);
        assert_eq!(objective(None), None);
    }
}
