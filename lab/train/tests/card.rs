//! The committed card, page and model files belong together.

use std::fs;
use std::path::Path;

use vantage_core::soarnet::Model;
use vantage_train::card::Card;

fn lab() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn card() -> Card {
    Card::read(&lab().join("models/card.json")).unwrap()
}

#[test]
fn the_page_is_drawn_from_the_figures() {
    let page = fs::read_to_string(lab().join("MODEL_CARD.md")).unwrap();
    assert!(page == card().page(), "draw lab/MODEL_CARD.md anew: cargo vantage card");
}

#[test]
fn the_figures_are_of_the_shipped_files() {
    let card = card();
    for (name, figures) in [("soarnet", &card.soarnet), ("soarnet-poses", &card.poses)] {
        let file = fs::read(lab().join(format!("models/{name}.model"))).unwrap();
        let model = Model::parse(&file).unwrap();
        assert_eq!((figures.bytes, figures.checksum), (file.len(), model.checksum()), "{name}");
    }
}
