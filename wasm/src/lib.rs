//! Vantage for JavaScript: types over `vantage-core`, no algorithm.
