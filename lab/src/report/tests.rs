//! The page, the sheet and the plots of a small plan with hostile strings in it.

use vantage_core::Scores;

use super::*;
use crate::record::{Normalise, PoolRecord, Scoring, Seconds, ViewRecord};

fn scores(level: f32) -> Scores {
    Scores { coverage: level, geometry: 0.9 * level, diversity: 0.4 * level, texture: level }
}

fn plan(views: usize) -> PlanRecord {
    let names = [Some("coverage"), Some("geometry"), Some("diversity"), Some("texture"), None];
    let view = |index: usize| ViewRecord {
        index: 7 * index,
        position: [3.0, index as f32 - 1.0, 1.0],
        world_from_camera: [[0.0; 4]; 4],
        objective: names[index % names.len()].map(String::from),
        reason: String::from("<img src=x onerror=alert(1)>"),
        gain: 0.5f32.powi(index as i32),
        scores: scores(0.1 * index as f32),
    };
    PlanRecord {
        object: String::from("a \"cup\" & <saucer>"),
        scheme: String::from("soar"),
        budget: views,
        seed: 1,
        pool_seed: Some(2),
        candidates: 64,
        pool: PoolRecord { space: "sphere".to_owned(), file: None, elevations: None, rings: None },
        scoring: Scoring { reading: "default".to_owned(), resolution: 256, object_seed: 0 },
        start: None,
        movement_cost: 0.0,
        stop: None,
        normalise: Normalise { world_from_object: [[0.0; 4]; 4] },
        views: (0..views).map(view).collect(),
        tour: (0..views).rev().collect(),
        exact: Some(scores(0.9)),
        smoothed: Some(scores(0.9).smoothed()),
        seconds: Seconds::default(),
    }
}

fn curves() -> Vec<Curve> {
    let scores: Vec<Scores> = (0..6).map(|n| scores(0.15 * n as f32)).collect();
    let curve = |label: &str, low: &[Scores]| Curve {
        label: label.into(),
        scores: scores.clone(),
        low: low.to_vec(),
        high: low.to_vec(),
    };
    vec![curve("soar", &[]), curve("random", &scores), curve("fps <3", &[])]
}

fn with_report<T>(views: usize, curves: &[Curve], use_it: impl FnOnce(&Report<'_>) -> T) -> T {
    let plan = plan(views);
    let photos: Vec<RgbaImage> = (0..views)
        .map(|index| RgbaImage::from_pixel(12, 8, image::Rgba([90, 80, 70, 255 - index as u8])))
        .collect();
    use_it(&Report {
        plan: &plan,
        photos: &photos,
        candidates: &[Vec3::X, Vec3::NAN, Vec3::NEG_Z],
        curves,
        profile: Profile::Trainer,
        folder: "out/it's",
        command: "vantage plan 'a&b.obj' --out out",
    })
}

#[test]
fn three_files_are_written() {
    let home = tempfile::tempdir().unwrap();
    with_report(5, &curves(), |report| report.write(home.path())).unwrap();
    for name in ["report.html", "contact_sheet.png", "scores.svg"] {
        assert!(home.path().join(name).metadata().unwrap().len() > 500, "{name}");
    }
    let sheet = image::open(home.path().join("contact_sheet.png")).unwrap();
    assert_eq!(sheet.color(), image::ColorType::Rgb8);
}

#[test]
fn nothing_foreign_becomes_markup_and_nothing_is_fetched() {
    let page = with_report(5, &curves(), html::page).unwrap();
    assert!(!page.contains("<img src=x") && !page.contains("<saucer>") && !page.contains("<3"));
    assert!(page.contains("a &quot;cup&quot; &amp; &lt;saucer&gt;"));
    assert!(page.contains("vantage plan &#39;a&amp;b.obj&#39; --out out"));
    assert!(!page.contains("<script") && !page.contains("@import") && !page.contains("<link"));
    for attribute in ["src=\"", "href=\""] {
        for (_, rest) in
            page.match_indices(attribute).map(|(at, found)| page.split_at(at + found.len()))
        {
            assert!(rest.starts_with("data:image/") || rest.starts_with('#'), "{}", &rest[..30]);
        }
    }
    // The only other address is the name of SVG itself.
    let addresses = page.matches("http").count();
    assert_eq!(addresses, page.matches("http://www.w3.org/2000/svg").count());
}

#[test]
fn every_view_has_a_photo_a_row_and_a_place_on_both_domes() {
    let page = with_report(5, &[], html::page).unwrap();
    for place in 1..=5 {
        assert_eq!(page.matches(&format!("id=\"view-{place}\"")).count(), 1);
        assert_eq!(page.matches(&format!("href=\"#view-{place}\"")).count(), 3);
        assert!(page.contains(&format!("alt=\"View {place} of 5, candidate ")));
    }
    assert!(!page.contains("Scores by number of views"));
}

#[test]
fn an_empty_plan_and_odd_numbers_are_drawn_all_the_same() {
    let mut odd = curves();
    odd[0].scores[3].coverage = f32::NAN;
    odd[1].scores.clear();
    odd[2].scores.truncate(1);
    with_report(0, &odd, |report| {
        assert!(html::page(report).is_ok());
        assert!(contact_sheet::draw(report.plan, report.photos).width() > 0);
    });
    assert!(plot::scores_svg(&odd).unwrap().contains("</svg>"));
    assert!(plot::scores_svg(&[]).is_err());
}

#[test]
fn a_missing_photo_is_refused() {
    let refused = with_report(3, &[], |report| {
        html::page(&Report { photos: &report.photos[1..], ..*report })
    });
    assert!(refused.unwrap_err().to_string().contains("2 photos and 3 views"));
}

#[test]
fn the_page_knows_the_colours_that_plots_are_drawn_in() {
    let svg = plot::panel_svg(vantage_core::Objective::Coverage, &curves()).unwrap();
    for rule in include_str!("page.css").lines().filter(|line| line.starts_with(".plot [")) {
        let selector = rule.split(['[', ']']).nth(1).unwrap();
        assert!(svg.contains(selector), "no element of the plots has {selector}");
    }
}
