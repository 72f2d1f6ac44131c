// The board that is printed: 5 x 4 tags of 40 mm, 10 mm apart; it fits A4 and Letter.

import type { BoardSpec } from "vantage-wasm";

export const BOARD: BoardSpec = { columns: 5, rows: 4, tagSizeM: 0.04, gapM: 0.01 };
