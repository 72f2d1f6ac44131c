/* A whole capture through vantage.h, over a recorded camera instead of a real one.
 *
 * It replays tests/sessions/golden and writes the same text as the Rust replay in
 * tests/sessions/src/replay.rs, numbers as bits; `cargo xtask test c` compares. A program for a real
 * board keeps capture(), and in the place of the recording moves a camera: see README.md. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "port.h"
#include "vantage.h"

enum { CANDIDATES = 64, VIEWS = 40, HEADER = 64, ENTRY = 64 };

/* All memory of a capture. Nothing is allocated. */
static _Alignas(VANTAGE_SESSION_ALIGN) uint8_t memory[VANTAGE_SESSION_SIZE(CANDIDATES, VIEWS)];
static uint8_t kept[32 * 1024];
static vantage_pose candidates[CANDIDATES];

/* ---- the recording: tests/sessions/FORMAT.md ---- */

enum mishap { NONE, BLOCKED, MISSED, ELSEWHERE };

struct recording {
    const uint8_t *entries;
    uint32_t candidates, width, height, format, frame_bytes, snapshot_after;
    vantage_plan plan;
};

struct entry {
    uint8_t mishap;
    vantage_pose candidate, reached;
    vantage_photo photo;
};

static uint32_t little_endian(const uint8_t *bytes, unsigned count)
{
    uint32_t value = 0;
    while (count-- > 0) {
        value = value << 8 | bytes[count];
    }
    return value;
}

static uint32_t bits_of(float value)
{
    union { float value; uint32_t bits; } both = { .value = value };
    return both.bits;
}

static float float_of(const uint8_t *bytes)
{
    union { uint32_t bits; float value; } both = { .bits = little_endian(bytes, 4) };
    return both.value;
}

static vantage_pose pose_of(const uint8_t *bytes)
{
    vantage_pose pose;
    for (unsigned i = 0; i < 3; i++) {
        pose.position_m[i] = float_of(bytes + 4 * i);
    }
    for (unsigned i = 0; i < 4; i++) {
        pose.rotation[i] = float_of(bytes + 12 + 4 * i);
    }
    return pose;
}

static bool open_recording(const uint8_t *bytes, size_t length, struct recording *recording)
{
    static const uint8_t bytes_of_pixel[] = { 2, 3, 1 }; /* by vantage_format */
    if (length < HEADER || little_endian(bytes, 4) != 0x43455256u /* "VREC" */
        || little_endian(bytes + 4, 2) != 1 || bytes[12] >= sizeof bytes_of_pixel) {
        return false;
    }
    uint32_t width = little_endian(bytes + 8, 2), height = little_endian(bytes + 10, 2);
    *recording = (struct recording) {
        .entries = bytes + HEADER,
        .candidates = little_endian(bytes + 6, 2),
        .width = width,
        .height = height,
        .format = bytes[12],
        .frame_bytes = width * height * bytes_of_pixel[bytes[12]],
        .snapshot_after = little_endian(bytes + 34, 2),
        .plan = {
            .scheme = bytes[13], /* the numbers are those of vantage_scheme */
            .budget_views = little_endian(bytes + 14, 2),
            .seed = little_endian(bytes + 16, 4) | (uint64_t)little_endian(bytes + 20, 4) << 32,
            .movement_cost = float_of(bytes + 24),
            .stop_gain = float_of(bytes + 28),
            .stop_patience = little_endian(bytes + 32, 2),
            .centre_m = { float_of(bytes + 36), float_of(bytes + 40), float_of(bytes + 44) },
        },
    };
    size_t entry = ENTRY + (size_t)recording->frame_bytes;
    return recording->candidates <= CANDIDATES && length == HEADER + recording->candidates * entry;
}

static struct entry entry_of(const struct recording *recording, uint32_t index)
{
    const uint8_t *bytes = recording->entries + index * (size_t)(ENTRY + recording->frame_bytes);
    return (struct entry) {
        .mishap = bytes[0],
        .candidate = pose_of(bytes + 4),
        .reached = pose_of(bytes + 32),
        .photo = {
            .pixels = bytes + ENTRY,
            .length = recording->frame_bytes,
            .width = recording->width,
            .height = recording->height,
            .format = recording->format,
        },
    };
}

/* ---- the text ---- */

static void put_number(uint32_t value)
{
    char digits[11], *first = digits + sizeof digits;
    *--first = '\0';
    do {
        *--first = (char)('0' + value % 10);
        value /= 10;
    } while (value > 0);
    port_put(first);
}

static void put_bits(uint32_t bits)
{
    char digits[9];
    for (unsigned i = 0; i < 8; i++) {
        digits[i] = "0123456789abcdef"[bits >> (28 - 4 * i) & 15];
    }
    digits[8] = '\0';
    port_put(digits);
}

static void put_refusal(const char *what, bool refused)
{
    port_put(refused ? "refused " : "accepted ");
    port_put(what);
    port_put("\n");
}

static bool put_view(vantage_session *session, const vantage_next *next, const char *what)
{
    static const char *const reasons[] = {
        "start", "chance", "farthest", "coverage", "geometry", "diversity", "texture", "all",
    };
    vantage_score_values scores;
    if (vantage_scores(session, &scores) != VANTAGE_STATUS_OK) {
        return false;
    }
    put_number(next->index);
    port_put(what);
    port_put(reasons[next->reason]);
    const float numbers[] = {
        next->gain, scores.coverage, scores.geometry, scores.diversity, scores.texture,
    };
    for (unsigned i = 0; i < 5; i++) {
        port_put(" ");
        put_bits(bits_of(numbers[i]));
    }
    port_put("\n");
    return true;
}

/* FNV-1a, as in the Rust replay. */
static uint32_t digest(const uint8_t *bytes, size_t length)
{
    uint32_t hash = 0x811c9dc5u;
    for (size_t i = 0; i < length; i++) {
        hash = (hash ^ bytes[i]) * 0x01000193u;
    }
    return hash;
}

/* ---- the capture ---- */

/* Takes what the planner asks for until there are so many photos or no next view. `missed` has a bit for
 * every candidate whose first attempt has failed. */
static vantage_status capture(vantage_session *session, const struct recording *recording,
                              uint64_t *missed, uint32_t photos)
{
    vantage_status status;
    vantage_next next;
    uint32_t taken;
    while ((status = vantage_view_count(session, &taken)) == VANTAGE_STATUS_OK && taken < photos
           && (status = vantage_next_view(session, &next)) == VANTAGE_STATUS_OK) {
        struct entry entry = entry_of(recording, next.index);
        uint64_t bit = (uint64_t)1 << next.index % 64;
        const char *what = NULL;
        if (entry.mishap == BLOCKED) {
            status = vantage_block(session, next.index);
            put_number(next.index);
            port_put(" blocked\n");
        } else if (entry.mishap == MISSED && (*missed & bit) == 0) {
            *missed |= bit;
            status = vantage_skip(session, next.index);
            put_number(next.index);
            port_put(" missed\n");
        } else if (entry.mishap == ELSEWHERE) {
            status = vantage_observe_elsewhere(session, &entry.reached, &entry.photo);
            if (status == VANTAGE_STATUS_OK) {
                status = vantage_block(session, next.index);
            }
            what = " elsewhere ";
        } else {
            status = vantage_observe(session, next.index, &entry.reached, &entry.photo);
            what = " taken ";
        }
        if (status != VANTAGE_STATUS_OK) {
            return status;
        }
        if (what != NULL && !put_view(session, &next, what)) {
            return VANTAGE_STATUS_NOT_A_SESSION;
        }
    }
    return status == VANTAGE_STATUS_DONE ? VANTAGE_STATUS_OK : status;
}

/* Bad input is refused, and the session goes on as if nothing had been. */
static void refusals(vantage_session *session, const struct recording *recording)
{
    struct entry entry = entry_of(recording, 0);
    vantage_photo cut = entry.photo;
    cut.length -= 1;
    put_refusal("a frame cut short",
                vantage_observe(session, 0, &entry.reached, &cut) == VANTAGE_STATUS_BAD_PHOTO);
    vantage_pose nowhere = entry.reached;
    nowhere.position_m[1] = __builtin_nanf("");
    put_refusal("a pose that is not a number",
                vantage_observe(session, 0, &nowhere, &entry.photo) == VANTAGE_STATUS_BAD_POSE);
    put_refusal("a candidate that is none",
                vantage_observe(session, recording->candidates, &entry.reached, &entry.photo)
                    == VANTAGE_STATUS_UNKNOWN_CANDIDATE);
    vantage_plan dear = recording->plan;
    dear.movement_cost = 2;
    put_refusal("a movement cost of 2", vantage_replan(session, &dear) == VANTAGE_STATUS_BAD_PLAN);
}

static vantage_status replay(const struct recording *recording)
{
    for (uint32_t i = 0; i < recording->candidates; i++) {
        candidates[i] = entry_of(recording, i).candidate;
    }
    put_number(recording->candidates);
    port_put(" candidates, budget ");
    put_number(recording->plan.budget_views);
    port_put("\n");

    vantage_session *session;
    vantage_status status =
        vantage_session_new(memory, sizeof memory, port_model, port_model_length, candidates,
                            recording->candidates, &recording->plan, VIEWS, &session);
    if (status != VANTAGE_STATUS_OK) {
        return status;
    }
    refusals(session, recording);
    uint64_t missed = 0;
    status = capture(session, recording, &missed, recording->snapshot_after);
    size_t length = 0;
    if (status == VANTAGE_STATUS_OK) {
        status = vantage_snapshot(session, kept, sizeof kept, &length);
    }
    if (status != VANTAGE_STATUS_OK) {
        return status;
    }
    port_put("snapshot ");
    put_number((uint32_t)length);
    port_put(" ");
    put_bits(digest(kept, length));
    port_put("\n");

    /* The power fails here: the session is made anew from what was kept. */
    kept[length / 2] ^= 0x10;
    status = vantage_session_restore(memory, sizeof memory, port_model, port_model_length, kept,
                                     length, VIEWS, &session);
    put_refusal("a damaged snapshot", status == VANTAGE_STATUS_BAD_SNAPSHOT);
    kept[length / 2] ^= 0x10;
    status = vantage_session_restore(memory, sizeof memory, port_model, port_model_length, kept,
                                     length, VIEWS, &session);
    if (status != VANTAGE_STATUS_OK) {
        return status;
    }
    missed = UINT64_MAX; /* whoever is asked again is not missed again */
    status = capture(session, recording, &missed, UINT32_MAX);
    vantage_finish_reason finish = VANTAGE_FINISH_REASON_NOT_YET;
    if (status == VANTAGE_STATUS_OK) {
        status = vantage_finish(session, &finish);
    }
    static const char *const reasons[] = {
        "more views\n", "budget spent\n", "good enough\n", "nothing left\n",
    };
    port_put(reasons[finish]);
    return status;
}

int main(void)
{
    if (vantage_abi() != VANTAGE_ABI || vantage_session_align() != VANTAGE_SESSION_ALIGN) {
        port_put("the library is of another version than vantage.h\n");
        return 1;
    }
    size_t needed = vantage_session_size(port_model, port_model_length, CANDIDATES, VIEWS);
    if (needed == 0 || needed > sizeof memory) {
        port_put("the model needs more memory than VANTAGE_SESSION_SIZE says\n");
        return 1;
    }
    for (size_t i = 0; i < port_recording_count; i++) {
        struct recording recording;
        port_put(i > 0 ? "\n[" : "[");
        port_put(port_recordings[i].name);
        port_put("]\n");
        if (!open_recording(port_recordings[i].bytes, port_recordings[i].length, &recording)) {
            port_put("these bytes are no recording\n");
            return 1;
        }
        vantage_status status = replay(&recording);
        if (status != VANTAGE_STATUS_OK) {
            port_put(vantage_status_text(status));
            port_put("\n");
            return 1;
        }
    }
    return 0;
}
