//! Host tools of Vantage: meshes, rendering, exact scores, plans and exports.

pub mod export;
pub mod record;
