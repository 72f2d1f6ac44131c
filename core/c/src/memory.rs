//! The caller's memory: pointers checked, and one block dealt out to the lists of a session.
//!
//! All `unsafe` that is not a function's signature is here and in `session.rs`.

use core::mem::{MaybeUninit, align_of, size_of, take};
use core::slice;

use vantage_core::planner::{self, Candidate, View};
use vantage_core::soarnet::features::{Direction, Stance};
use vantage_core::soarnet::{
    Dimensions, Form, Lists, ListsMut, Memory, OUTLOOK, RANKS, SKETCH, Scratch, Standpoint,
};

use crate::status::Status;

/// What a session's memory must be aligned to. Every part of it begins on such a border.
pub const VANTAGE_SESSION_ALIGN: usize = 16;

/// A value of the caller's.
///
/// # Safety
///
/// `pointer` is null, misaligned, or valid for reading one value that does not change meanwhile.
pub unsafe fn reference<'a, T>(pointer: *const T) -> Result<&'a T, Status> {
    if !pointer.is_aligned() {
        return Err(Status::Misaligned);
    }
    // SAFETY: it is aligned, and else as the caller promises.
    unsafe { pointer.as_ref() }.ok_or(Status::NullPointer)
}

/// A value of the caller's, to write.
///
/// # Safety
///
/// `pointer` is null, misaligned, or valid for one value that nobody else uses meanwhile.
pub unsafe fn reference_mut<'a, T>(pointer: *mut T) -> Result<&'a mut T, Status> {
    if !pointer.is_aligned() {
        return Err(Status::Misaligned);
    }
    // SAFETY: it is aligned, and else as the caller promises.
    unsafe { pointer.as_mut() }.ok_or(Status::NullPointer)
}

/// A list of the caller's.
///
/// # Safety
///
/// `pointer` is null, misaligned, or valid for reading `count` values that do not change meanwhile.
pub unsafe fn list<'a, T>(pointer: *const T, count: usize) -> Result<&'a [T], Status> {
    // SAFETY: for one value as for all of them.
    unsafe { reference(pointer) }?;
    check_length::<T>(count)?;
    // SAFETY: not null, aligned, no longer than any object may be, and else as the caller promises.
    Ok(unsafe { slice::from_raw_parts(pointer, count) })
}

/// Bytes of the caller's.
///
/// # Safety
///
/// As of [`list`].
pub unsafe fn bytes<'a>(pointer: *const u8, length: usize) -> Result<&'a [u8], Status> {
    // SAFETY: the caller's promise is the same.
    unsafe { list(pointer, length) }
}

/// Bytes of the caller's, to write.
///
/// # Safety
///
/// `pointer` is null or valid for `length` bytes that nobody else uses meanwhile.
pub unsafe fn bytes_mut<'a>(pointer: *mut u8, length: usize) -> Result<&'a mut [u8], Status> {
    if pointer.is_null() {
        return Err(Status::NullPointer);
    }
    check_length::<u8>(length)?;
    // SAFETY: not null, no longer than any object may be, and else as the caller promises.
    Ok(unsafe { slice::from_raw_parts_mut(pointer, length) })
}

/// No object is longer than `isize::MAX` bytes.
fn check_length<T>(count: usize) -> Result<(), Status> {
    let bytes = count.checked_mul(size_of::<T>()).ok_or(Status::BadNumber)?;
    isize::try_from(bytes).map(|_| ()).map_err(|_| Status::BadNumber)
}

/// The part of the caller's block that has not been dealt out yet.
#[derive(Debug)]
pub struct Block(&'static mut [MaybeUninit<u8>]);

impl Block {
    /// A block of the caller's.
    ///
    /// # Safety
    ///
    /// `memory` is null, misaligned, or valid for `size` bytes that nobody else uses until the session
    /// in it is used no more.
    pub unsafe fn try_new(memory: *mut u8, size: usize) -> Result<Self, Status> {
        if memory.is_null() {
            return Err(Status::NullPointer);
        }
        if !memory.addr().is_multiple_of(VANTAGE_SESSION_ALIGN) {
            return Err(Status::Misaligned);
        }
        check_length::<u8>(size)?;
        // SAFETY: not null, no longer than any object may be, and else as the caller promises.
        Ok(Self(unsafe { slice::from_raw_parts_mut(memory.cast(), size) }))
    }

    /// Takes `count` places off the front.
    fn take<T>(&mut self, count: usize) -> Result<&'static mut [MaybeUninit<T>], Status> {
        const { assert!(align_of::<T>() <= VANTAGE_SESSION_ALIGN) };
        let size = padded::<T>(count).ok_or(Status::BadNumber)?;
        if size > self.0.len() {
            return Err(Status::MemoryTooSmall);
        }
        let (part, rest) = take(&mut self.0).split_at_mut_checked(size).unwrap_or_default();
        self.0 = rest;
        // SAFETY: the part is `size` bytes long, at least `count` times a T; it begins on a border of
        // VANTAGE_SESSION_ALIGN, as the block does and all parts before it end; it is borrowed from
        // the block for good; and a place for a T may hold any bytes.
        Ok(unsafe { slice::from_raw_parts_mut(part.as_mut_ptr().cast(), count) })
    }

    /// The same, each place holding `value`.
    fn filled<T: Copy>(&mut self, count: usize, value: T) -> Result<&'static mut [T], Status> {
        let places = self.take(count)?;
        places.fill(MaybeUninit::new(value));
        // SAFETY: every place has just been written.
        Ok(unsafe { places.assume_init_mut() })
    }

    /// Takes one place off the front.
    pub fn place<T>(&mut self) -> Result<&'static mut MaybeUninit<T>, Status> {
        self.take(1)?.first_mut().ok_or(Status::MemoryTooSmall)
    }
}

/// Bytes of `count` places up to the next border; `None` where they are more than any memory has.
pub fn padded<T>(count: usize) -> Option<usize> {
    count.checked_mul(size_of::<T>())?.checked_next_multiple_of(VANTAGE_SESSION_ALIGN)
}

/// How many candidates and views there is room for, and of which model.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// The model's sizes.
    pub sizes: Dimensions,
    /// Candidates.
    pub candidates: usize,
    /// Views.
    pub views: usize,
}

impl Room {
    fn sketches(&self) -> usize {
        if self.sizes.embedding > 0 { self.views } else { 0 }
    }

    /// Bytes of all lists; `None` where they are more than any memory has.
    pub fn size(&self) -> Option<usize> {
        let Self { sizes: Dimensions { width, embedding, .. }, candidates, views } = *self;
        let parts = [
            padded::<Candidate>(candidates),
            padded::<View>(views),
            padded::<Direction>(candidates),
            padded::<i16>(candidates.checked_mul(width)?),
            padded::<i8>(candidates.checked_mul(width)?),
            padded::<[i32; OUTLOOK]>(candidates),
            padded::<[i32; RANKS]>(candidates),
            padded::<Standpoint>(candidates),
            padded::<i8>(views.checked_mul(embedding)?),
            padded::<[i8; SKETCH]>(self.sketches()),
            padded::<Stance>(views),
            padded::<Standpoint>(views),
            padded::<Form>(1),
            padded::<Scratch>(1),
        ];
        parts.into_iter().try_fold(0usize, |sum, part| sum.checked_add(part?))
    }
}

/// The lists of a session.
#[derive(Debug)]
pub struct SessionLists {
    candidates: &'static mut [MaybeUninit<Candidate>], // the first `candidate_count` are written
    candidate_count: usize,
    views: &'static mut [MaybeUninit<View>], // the first `view_count` are written
    view_count: usize,
}

/// The lists of a network.
#[derive(Debug)]
pub struct NetworkLists(ListsMut<'static>);

/// Deals a block out; no list is longer than it has to be.
pub fn deal(block: &mut Block, room: Room) -> Result<(SessionLists, NetworkLists), Status> {
    let Room { sizes: Dimensions { width, embedding, .. }, candidates, views } = room;
    let values = |rows: usize, columns: usize| rows.checked_mul(columns).ok_or(Status::BadNumber);
    let session = SessionLists {
        candidates: block.take(candidates)?,
        candidate_count: 0,
        views: block.take(views)?,
        view_count: 0,
    };
    let network = ListsMut {
        directions: block.filled(candidates, Direction::default())?,
        sums: block.filled(values(candidates, width)?, 0)?,
        maxima: block.filled(values(candidates, width)?, 0)?,
        outlooks: block.filled(candidates, [0; OUTLOOK])?,
        ranks: block.filled(candidates, [0; RANKS])?,
        standpoints: block.filled(candidates, Standpoint::NONE)?,
        embeddings: block.filled(values(views, embedding)?, 0)?,
        sketches: block.filled(room.sketches(), [0; SKETCH])?,
        stances: block.filled(views, Stance::default())?,
        taken: block.filled(views, Standpoint::NONE)?,
        form: block.place()?.write(Form::new()),
        scratch: block.place()?.write(Scratch::new()),
    };
    Ok((session, NetworkLists(network)))
}

impl planner::Memory for SessionLists {
    fn candidates(&self) -> &[Candidate] {
        let written = self.candidates.get(..self.candidate_count).unwrap_or_default();
        // SAFETY: that many have been written.
        unsafe { written.assume_init_ref() }
    }

    fn candidates_mut(&mut self) -> &mut [Candidate] {
        let written = self.candidates.get_mut(..self.candidate_count).unwrap_or_default();
        // SAFETY: that many have been written.
        unsafe { written.assume_init_mut() }
    }

    fn push_candidate(&mut self, candidate: Candidate) -> Result<(), Candidate> {
        let Some(place) = self.candidates.get_mut(self.candidate_count) else {
            return Err(candidate);
        };
        place.write(candidate);
        self.candidate_count += 1;
        Ok(())
    }

    fn views(&self) -> &[View] {
        let written = self.views.get(..self.view_count).unwrap_or_default();
        // SAFETY: that many have been written.
        unsafe { written.assume_init_ref() }
    }

    fn push_view(&mut self, view: View) -> Result<(), View> {
        let Some(place) = self.views.get_mut(self.view_count) else { return Err(view) };
        place.write(view);
        self.view_count += 1;
        Ok(())
    }

    fn view_capacity(&self) -> usize {
        self.views.len()
    }

    fn clear(&mut self) {
        self.candidate_count = 0;
        self.view_count = 0;
    }
}

impl Memory for NetworkLists {
    fn lists(&self) -> Lists<'_> {
        let ListsMut { sums, maxima, outlooks, ranks, standpoints, .. } = &self.0;
        let ListsMut { embeddings, sketches, stances, taken, .. } = &self.0;
        Lists { sums, maxima, outlooks, ranks, standpoints, embeddings, sketches, stances, taken }
    }

    fn lists_mut(&mut self) -> ListsMut<'_> {
        let lists = &mut self.0;
        ListsMut {
            directions: lists.directions,
            sums: lists.sums,
            maxima: lists.maxima,
            outlooks: lists.outlooks,
            ranks: lists.ranks,
            standpoints: lists.standpoints,
            embeddings: lists.embeddings,
            sketches: lists.sketches,
            stances: lists.stances,
            taken: lists.taken,
            form: lists.form,
            scratch: lists.scratch,
        }
    }
}
