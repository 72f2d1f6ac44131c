//! Host tools of Vantage: meshes, rendering, exact scores, plans and exports.

pub mod blind;
pub mod commands;
pub mod dataset;
pub mod exact;
pub mod export;
mod heap;
pub mod label;
pub mod mesh;
pub mod metrics;
pub mod network;
pub mod object;
pub mod photos;
pub mod pool;
pub mod port;
pub mod record;
pub mod render;
pub mod report;
pub mod scheme;
pub mod seen_points;
pub mod statistics;
pub mod support;
pub mod surface;
