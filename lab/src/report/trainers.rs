//! How each trainer opens a folder.

use crate::export::Profile;

/// One trainer's command.
pub(super) struct Opening {
    /// The trainer.
    pub name: &'static str,
    /// The command, with the folder filled in.
    pub command: String,
    /// What its defaults do that one would not expect; may be empty.
    pub note: &'static str,
}

/// The commands for a folder of this profile; `folder` is quoted for a POSIX shell where needed.
pub(super) fn openings(profile: Profile<'_>, folder: &str) -> Vec<Opening> {
    let dir = quoted(folder);
    let sub = |name: &str| quoted(&format!("{}/{name}", folder.trim_end_matches('/')));
    let opening = |name, command, note| Opening { name, command, note };
    if profile.is_trainer() {
        vec![
            opening(
                "nerfstudio",
                format!("ns-train splatfacto --data {dir}"),
                "Keeps a tenth of the photos for evaluation; add nerfstudio-data --eval-mode all \
                 to train on every planned view.",
            ),
            opening("brush", format!("brush_app {dir}"), ""),
            opening(
                "gsplat",
                format!("python simple_trainer.py default --data_dir {dir} --data_factor 1"),
                "In gsplat’s examples folder. Its default factor of 4 looks for photos made \
                 smaller beforehand; every eighth photo is kept for evaluation.",
            ),
            opening("3D Gaussian Splatting (Inria)", format!("python train.py -s {dir}"), ""),
            opening(
                "instant-ngp",
                format!("./instant-ngp --scene {dir}"),
                "Or ./instant-ngp and the folder. It names the .json files without frames, and \
                 skips them.",
            ),
            opening(
                "COLMAP",
                format!(
                    "colmap gui --import_path {} --image_path {}",
                    sub("sparse/0"),
                    sub("images")
                ),
                "",
            ),
        ]
    } else {
        vec![
            opening("nerfstudio", format!("ns-train splatfacto blender-data --data {dir}"), ""),
            opening("brush", format!("brush_app {dir}"), ""),
            opening(
                "3D Gaussian Splatting (Inria)",
                format!("python train.py -s {dir} --eval -w"),
                "-w: white behind the object.",
            ),
            opening(
                "instant-ngp",
                format!("./instant-ngp --scene {}", sub("transforms_train.json")),
                "Given the folder, it would train on the test views too.",
            ),
        ]
    }
}

/// The word as a POSIX shell reads it back.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+,=:@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_with_spaces_is_one_word() {
        assert_eq!(quoted("out/teapot"), "out/teapot");
        assert_eq!(quoted("my photos"), "'my photos'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
    }

    #[test]
    fn every_command_names_the_folder() {
        let openings = openings(Profile::Trainer, "out/ship/");
        assert!(openings.iter().all(|opening| opening.command.contains("out/ship/")));
        assert!(openings.iter().any(|opening| opening.command.contains("out/ship/sparse/0")));
    }
}
