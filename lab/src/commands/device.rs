//! `cargo vantage device`: a session in a microcontroller, asked over a serial port.

use std::fs;
use std::path::PathBuf;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result, anyhow, bail};
use clap::{Args, Subcommand};
use image::RgbImage;
use serde_json::json;
use vantage_core::planner::{Finish, Plan, Session};
use vantage_core::soarnet::{Image, Photo, Pixels, SIDE};
use vantage_core::{Objective, Pose};
use vantage_device::message::{Change, Kept, Next, Posture};
use vantage_device::{Client, Frame, Status};

use crate::heap::Heap;
use crate::network::{self, Network};
use crate::object::Object;
use crate::pool::PoolArgs;
use crate::port::Port;

/// Options of `device`.
#[derive(Args, Clone, Debug)]
pub struct DeviceArgs {
    /// Where the device is: a serial port such as /dev/ttyACM0 or COM3, or tcp:HOST:PORT
    #[arg(long, short, value_name = "PORT")]
    pub port: String,
    /// Speed of the serial port, bits a second
    #[arg(long, default_value_t = 115_200, value_name = "N")]
    pub baud: u32,
    /// How long an answer may take, seconds
    #[arg(long, default_value_t = 3.0, value_name = "S")]
    pub patience: f32,
    #[command(subcommand)]
    pub task: Task,
}

/// What to do with the device.
#[derive(Subcommand, Clone, Debug)]
pub enum Task {
    /// Say how things stand
    Status {
        /// Print it as JSON
        #[arg(long)]
        json: bool,
    },
    /// Say where to stand next
    Next,
    /// Let the device plan a capture of an object, photographed here, and compare it with the plan of
    /// this computer
    Plan {
        /// A GLB, glTF or OBJ file, or a built-in object: shelf (if left out), chair, vase, knot,
        /// blob or ball
        object: Option<String>,
        /// Number of views to choose
        #[arg(long, short, default_value_t = 20, value_name = "B")]
        budget: usize,
        #[command(flatten)]
        pool: PoolArgs,
    },
    /// Say that a candidate is out of reach
    Block {
        /// Its index
        index: u32,
    },
    /// Say that a candidate is within reach again
    Unblock {
        /// Its index
        index: u32,
    },
    /// Save the device's session to a file
    Snapshot {
        /// The file to write
        file: PathBuf,
    },
    /// Give the device the session of a file
    Restore {
        /// The file to read
        file: PathBuf,
    },
}

/// The longest snapshot that is read: 256 views of the largest network.
const LONGEST_SNAPSHOT: usize = 1 << 20;

/// Does what was asked.
pub fn run(args: &DeviceArgs) -> Result<()> {
    if !(0.01..=600.0).contains(&args.patience) {
        bail!("an answer cannot be awaited for {} s: give --patience 0.01 to 600", args.patience);
    }
    let patience = Duration::from_secs_f32(args.patience);
    let port = Port::open(&args.port, args.baud, patience)?;
    let mut client = Client::new(port, by_chance());
    match &args.task {
        Task::Status { json } => {
            let status = client.status()?;
            super::print(&if *json { status_json(&status)? } else { status_text(&status) })
        }
        Task::Next => super::print(&match client.next_view()? {
            Next::View(next) => {
                let [x, y, z] = next.pose.position().to_array();
                format!("view {}: {}, at ({x:.3}, {y:.3}, {z:.3}) m\n", next.index, next.reason)
            }
            Next::Finished(finish) => format!("{}\n", ended(finish)),
        }),
        Task::Plan { object, budget, pool } => {
            plan(&mut client, object.as_deref(), *budget, &pool.poses()?)
        }
        Task::Block { index } => change(&mut client, Change::Block(*index)),
        Task::Unblock { index } => change(&mut client, Change::Unblock(*index)),
        Task::Snapshot { file } => {
            let mut bytes = vec![0; LONGEST_SNAPSHOT];
            let length = client.snapshot(&mut bytes)?;
            fs::write(file, &bytes[..length])
                .with_context(|| format!("cannot write {}", file.display()))
        }
        Task::Restore { file } => {
            let bytes =
                fs::read(file).with_context(|| format!("cannot read {}", file.display()))?;
            Ok(client.restore(by_chance().max(1), &bytes)?)
        }
    }
}

fn change(client: &mut Client<Port>, change: Change) -> Result<()> {
    client.status()?; // whose session it is
    Ok(client.change(change)?)
}

/// A number that another run will not choose.
fn by_chance() -> u32 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (now.as_nanos() as u32) ^ std::process::id().rotate_left(16)
}

fn ended(finish: Finish) -> &'static str {
    match finish {
        Finish::BudgetSpent => "all views are taken",
        Finish::GoodEnough => "further views promise too little",
        Finish::NothingLeft => "every candidate is visited or out of reach",
    }
}

fn status_text(status: &Status) -> String {
    let model = match &status.model {
        Ok(sees) => format!(
            "{:08x}, looks at {}",
            sees.checksum,
            if sees.photos { "photos" } else { "poses alone" }
        ),
        Err(fault) => fault.to_string(),
    };
    let session = match &status.session {
        Some(progress) => format!(
            "{} of {} views, {} candidates, {} changes; coverage {:.2}, geometry {:.2}, \
             diversity {:.2}, texture {:.2}",
            progress.views,
            progress.budget,
            progress.candidates,
            progress.revision,
            progress.scores.coverage,
            progress.scores.geometry,
            progress.scores.diversity,
            progress.scores.texture
        ),
        None => "none".to_owned(),
    };
    let kept = match status.kept {
        Kept::Nothing => "nothing",
        Kept::Session => "the session as it stands",
        Kept::Failed => "an older session: the last change could not be written",
    };
    let (room, line) = (&status.room, &status.line);
    format!(
        "model    {model}\nroom     {} candidates, {} views, {} bytes a transfer\n\
         session  {session}\nflash    {kept}\n\
         line     {} packets, {} damaged, {} requests refused\n",
        room.candidates, room.views, room.transfer, line.packets, line.damaged, line.refused
    )
}

fn status_json(status: &Status) -> Result<String> {
    let model = match &status.model {
        Ok(sees) => json!({ "checksum": sees.checksum, "photos": sees.photos }),
        Err(fault) => json!({ "fault": fault.to_string() }),
    };
    let value = json!({
        "model": model,
        "room": status.room,
        "session": status.session,
        "flash": status.kept,
        "line": status.line,
    });
    Ok(serde_json::to_string_pretty(&value)? + "\n")
}

/// Lets the device plan, and this computer too.
fn plan(
    client: &mut Client<Port>,
    object: Option<&str>,
    budget: usize,
    poses: &[Pose],
) -> Result<()> {
    let object = Object::open(object, 0)?;
    let status = client.status()?;
    let sees = status.model.map_err(|fault| anyhow!("{fault}"))?;
    let network = if sees.photos { Network::shipped() } else { Network::shipped_poses() };
    if network.checksum()? != sees.checksum {
        bail!(
            "the device has another model than this program, so the plans cannot be compared: \
             build firmware and program from one release"
        );
    }
    // As they come out of the line: normalised once more.
    let poses: Vec<Pose> =
        poses.iter().map(|pose| Posture::from(pose).pose()).collect::<Result<_, _>>()?;
    let photos: Vec<Vec<u8>> = network::photos(&object.mesh, &poses)?.iter().map(rgb565).collect();
    let plan = Plan::support(budget);
    client.open_listed(by_chance().max(1), plan, &poses)?;

    let scorer = network.scorer(&poses, budget)?;
    let mut here = Session::try_new(Heap::default(), poses.iter().copied(), scorer, plan)?;
    loop {
        let (there, own) = (client.next_view()?, here.next_view());
        let next = match there {
            Next::View(next) => next,
            Next::Finished(finish) if own.is_none() => {
                let text = format!("{}; the plan of this computer is the same\n", ended(finish));
                return super::print(&text);
            }
            Next::Finished(_) => bail!("the device ended where this computer goes on"),
        };
        let own = own.ok_or_else(|| anyhow!("the device goes on where this computer ended"))?;
        let letter = next.objective.map_or('-', Objective::letter);
        super::print(&format!("{:3} {letter} {:.4}\n", next.index, next.gain))?;
        if (next.index, next.gain.to_bits()) != (own.index, own.gain.to_bits()) {
            bail!(
                "the device chose view {} for a gain of {}, this computer view {} for {}",
                next.index,
                next.gain,
                own.index,
                own.gain
            );
        }
        let pose = poses.get(next.index).context("the device chose a view that is none")?;
        let side = SIDE as u32;
        let bytes = &photos[next.index];
        let frame = Frame { width: side, height: side, pixels: Pixels::Rgb565, bytes };
        client.observe(Some(next.index), pose, sees.photos.then_some(frame))?;
        let image = Image::try_new(side, side, Pixels::Rgb565, bytes)?;
        let reached = Posture::from(pose).pose()?;
        here.observe(next.index, reached, &Photo::new(image))?;
    }
}

/// A photo in two bytes a pixel, each colour to its nearest.
fn rgb565(photo: &RgbImage) -> Vec<u8> {
    let bits = |value: u8, most: u32| (u32::from(value) * most + 127) / 255;
    let pixel = |pixel: &image::Rgb<u8>| {
        let [r, g, b] = pixel.0;
        ((bits(r, 31) << 11 | bits(g, 63) << 5 | bits(b, 31)) as u16).to_le_bytes()
    };
    photo.pixels().flat_map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use vantage_core::Scores;
    use vantage_device::message::{ModelFault, Progress, Room, Sees, Traffic};

    fn status() -> Status {
        let scores = Scores { coverage: 0.5, geometry: 0.25, diversity: 0.125, texture: 1.0 };
        Status {
            model: Ok(Sees { checksum: 0xab, photos: true }),
            room: Room { candidates: 128, views: 64, transfer: 40_960 },
            session: Some(Progress {
                session: 3,
                revision: 9,
                candidates: 100,
                views: 7,
                budget: 20,
                scores,
            }),
            line: Traffic { packets: 40, damaged: 2, refused: 1 },
            kept: Kept::Session,
        }
    }

    #[test]
    fn a_status_is_told_in_words_and_as_json() {
        let text = status_text(&status());
        for part in ["000000ab, looks at photos", "7 of 20 views", "coverage 0.50", "2 damaged"] {
            assert!(text.contains(part), "{text}");
        }
        let json: serde_json::Value =
            serde_json::from_str(&status_json(&status()).unwrap()).unwrap();
        assert_eq!(json["session"]["views"], 7);
        assert_eq!(json["room"]["candidates"], 128);
        let bad = Status { model: Err(ModelFault::Version { got: 9 }), session: None, ..status() };
        assert!(status_text(&bad).contains("version 9"));
        assert!(status_text(&bad).contains("session  none"));
    }

    #[test]
    fn colours_go_to_the_nearest_of_five_and_six_bits() {
        let photo = RgbImage::from_fn(4, 1, |x, _| {
            image::Rgb([[255, 255, 255], [255, 0, 0], [4, 2, 4], [5, 3, 0]][x as usize])
        });
        let values: Vec<u16> =
            rgb565(&photo).chunks(2).map(|two| u16::from_le_bytes([two[0], two[1]])).collect();
        assert_eq!(values, [0xffff, 0xf800, 0x0000, 1 << 11 | 1 << 5]);
    }
}
