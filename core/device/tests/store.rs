//! Two slots: after a cut at any write or erase, the store holds the old record or the new one.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "in a test a panic is the finding; clippy knows only functions marked as tests"
)]

mod common;

use common::{Flash, NoPower, PAGE};
use proptest::prelude::*;
use vantage_device::{Store, StoreError};

const SLOT: usize = 3 * PAGE;

fn open<const W: usize>(flash: &Flash<W>) -> Store<Flash<W>> {
    Store::try_new(flash.clone(), PAGE as u32, (PAGE + 2 * SLOT) as u32).unwrap()
}

fn load<const W: usize>(store: &mut Store<Flash<W>>) -> Option<Vec<u8>> {
    let mut buffer = vec![0; SLOT];
    let length = store.load(&mut buffer).unwrap()?;
    buffer.truncate(length);
    Some(buffer)
}

fn record(number: usize, length: usize) -> Vec<u8> {
    (0..length).map(|place| (place * 7 + number * 31) as u8).collect()
}

/// Cuts power at every write and erase of each of a few saves; gives the number of cuts.
fn cut_everywhere<const W: usize>(lengths: &[usize]) -> u32 {
    let mut cuts = 0;
    for after in 0.. {
        let flash = Flash::<W>::new(1 + 6, u64::from(after));
        let mut newest = None;
        let mut cut = false;
        flash.cut(Some(after));
        for (number, &length) in lengths.iter().enumerate() {
            let new = record(number, length);
            let saved = open(&flash).save(&new);
            if saved.is_ok() {
                newest = Some(new);
                continue;
            }
            // Power comes back.
            assert_eq!(saved, Err(StoreError::Flash(NoPower)));
            cut = true;
            flash.cut(None);
            let mut store = open(&flash);
            let found = load(&mut store);
            assert!(found == newest || found == Some(new), "cut {after} in save {number}");
            newest = Some(record(99, length));
            store.save(newest.as_ref().unwrap()).unwrap();
            assert_eq!(load(&mut store), newest);
            assert_eq!(load(&mut open(&flash)), newest, "saving goes on after cut {after}");
        }
        assert_eq!(load(&mut open(&flash)), newest);
        if !cut {
            return cuts;
        }
        cuts += 1;
    }
    unreachable!("the loop ends with the first run without a cut")
}

#[test]
fn a_cut_at_any_write_or_erase_leaves_a_good_record() {
    // An erase, a write for each 256 bytes, and one of the header.
    assert_eq!(cut_everywhere::<1>(&[1000, 3000, 10, 5000]), 6 + 14 + 3 + 22);
    cut_everywhere::<4>(&[256, 257, SLOT - 20]);
    cut_everywhere::<8>(&[100, 0, 2000]);
    cut_everywhere::<32>(&[31, 32, 33, 4000]);
    cut_everywhere::<256>(&[300, 600, 900]);
}

#[test]
fn a_second_cut_while_power_comes_back_leaves_the_same_record() {
    for first in 0..8 {
        for second in 0..8 {
            let flash = Flash::<4>::new(7, first * 8 + second);
            open(&flash).save(&record(1, 900)).unwrap();
            flash.cut(Some(first as u32));
            let saved = open(&flash).save(&record(2, 900)).is_ok();
            flash.cut(None);
            let mut store = open(&flash);
            flash.cut(Some(second as u32));
            let again = store.save(&record(3, 900)).is_ok();
            flash.cut(None);
            let expected = if again {
                3
            } else if saved {
                2
            } else {
                1
            };
            let found = load(&mut open(&flash)).unwrap();
            // The last byte of a header may be all that a cut leaves out, and then it may be right.
            let possible = [expected, expected.max(2), 3].map(|number| record(number, 900));
            assert!(possible.contains(&found), "{first} {second}");
        }
    }
}

#[test]
fn an_empty_flash_holds_nothing_and_regions_are_checked() {
    let flash = Flash::<4>::new(4, 0);
    assert_eq!(load(&mut Store::try_new(flash.clone(), 0, 2 * PAGE as u32).unwrap()), None);
    for (from, to) in [(0, PAGE), (1, 2 * PAGE + 1), (PAGE, PAGE), (0, 6 * PAGE), (0, 3 * PAGE)] {
        let store = Store::try_new(flash.clone(), from as u32, to as u32);
        assert_eq!(store.err(), Some(StoreError::Region), "{from} {to}");
    }
    let mut store = Store::try_new(flash, 0, 2 * PAGE as u32).unwrap();
    let room = PAGE - 20;
    assert_eq!(store.room(), room);
    assert_eq!(store.save(&vec![1; room + 1]), Err(StoreError::TooLong { room }));
    store.save(&vec![1; room]).unwrap();
    assert_eq!(store.load(&mut [0; 10]), Err(StoreError::NoRoom));
}

#[test]
fn saves_take_turns_between_the_slots() {
    let flash = Flash::<4>::new(7, 0);
    let mut store = open(&flash);
    for number in 0..5 {
        store.save(&record(number, 50)).unwrap();
    }
    let bytes = &flash.0.borrow().bytes;
    let number = |slot: usize| bytes[PAGE + slot * SLOT + 4];
    assert_eq!([number(0), number(1)], [4, 3]);
}

proptest! {
    #[test]
    fn whatever_is_in_flash_nothing_panics_and_no_damaged_record_is_taken(
        place in 0..2 * SLOT,
        change in 1u8..,
        noise in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        let flash = Flash::<4>::new(7, 0);
        open(&flash).save(&record(0, 700)).unwrap();
        open(&flash).save(&record(1, 700)).unwrap();
        flash.0.borrow_mut().bytes[PAGE + place] ^= change;
        let found = load(&mut open(&flash));
        prop_assert!(found == Some(record(0, 700)) || found == Some(record(1, 700)));
        flash.0.borrow_mut().bytes[PAGE..PAGE + noise.len()].copy_from_slice(&noise);
        flash.0.borrow_mut().bytes[PAGE + SLOT..][..noise.len()].copy_from_slice(&noise);
        let _ = load(&mut open(&flash));
    }
}
