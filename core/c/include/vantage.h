/* Written by `cargo xtask header` from core/c/src; do not edit. */
/*
 * Vantage: the next best photo of an object, on whatever holds the camera.
 *
 * Memory is yours, one block for a session: no heap, no global state, no panics. Every call returns a
 * status. A session is used by one thread or interrupt level at a time. Lengths are metres, angles
 * radians. examples/c/README.md shows a whole program.
 */

#ifndef VANTAGE_H
#define VANTAGE_H



#include <stddef.h>
#include <stdint.h>

/* The bytes of a session for a static array, for models of the default sizes; what it really needs is
 * said by vantage_session_size(). Align it: _Alignas(VANTAGE_SESSION_ALIGN). */
#define VANTAGE_SESSION_SIZE(candidates, views) \
    (VANTAGE_SESSION_BYTES + (candidates) * VANTAGE_CANDIDATE_BYTES + (views) * VANTAGE_VIEW_BYTES)

/*
 The version of this interface: it changes when a program must be compiled again.
 */
#define VANTAGE_ABI 1

/*
 Bytes of a session that do not depend on its candidates and views: for `VANTAGE_SESSION_SIZE`.
 */
#define VANTAGE_SESSION_BYTES 81152

/*
 Bytes for each candidate, for models of the default sizes.
 */
#define VANTAGE_CANDIDATE_BYTES 528

/*
 Bytes for each view, for models of the default sizes.
 */
#define VANTAGE_VIEW_BYTES 628

/*
 What a session's memory must be aligned to. Every part of it begins on such a border.
 */
#define VANTAGE_SESSION_ALIGN 16

/*
 What became of a call. After anything but `VANTAGE_STATUS_OK` and `VANTAGE_STATUS_DONE` nothing has
 changed, but where a session was to be made or restored: its memory may then be used anew.
 */
enum vantage_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     It did what it says.
     */
    VANTAGE_STATUS_OK = 0,
    /*
     There is no next view: see `vantage_finish`.
     */
    VANTAGE_STATUS_DONE = 1,
    /*
     A pointer is null.
     */
    VANTAGE_STATUS_NULL_POINTER = 2,
    /*
     The pointer does not lead to a session.
     */
    VANTAGE_STATUS_NOT_A_SESSION = 3,
    /*
     A pointer is not aligned as its type asks, or the memory not to `VANTAGE_SESSION_ALIGN`.
     */
    VANTAGE_STATUS_MISALIGNED = 4,
    /*
     The memory is smaller than `vantage_session_size` says.
     */
    VANTAGE_STATUS_MEMORY_TOO_SMALL = 5,
    /*
     A number means nothing: a scheme, a format, a view space, a length beyond all memory.
     */
    VANTAGE_STATUS_BAD_NUMBER = 6,
    /*
     The bytes are no model, or a damaged one.
     */
    VANTAGE_STATUS_BAD_MODEL = 7,
    /*
     The model was written in another version.
     */
    VANTAGE_STATUS_OTHER_MODEL_VERSION = 8,
    /*
     A coordinate is not finite, or the rotation no rotation.
     */
    VANTAGE_STATUS_BAD_POSE = 9,
    /*
     The view space's radius, elevations, rings, turns or target make no candidates.
     */
    VANTAGE_STATUS_BAD_POOL = 10,
    /*
     The plan cannot be carried out: budget, movement cost, stop rule or centre.
     */
    VANTAGE_STATUS_BAD_PLAN = 11,
    /*
     A candidate or a camera stands on the object's centre.
     */
    VANTAGE_STATUS_ON_THE_CENTRE = 12,
    /*
     The photo's bytes are not as many as width, height and format ask for, it has no pixels, or its
     window is too large.
     */
    VANTAGE_STATUS_BAD_PHOTO = 13,
    /*
     The model looks at photos and was given none.
     */
    VANTAGE_STATUS_NO_PHOTO = 14,
    /*
     There is no candidate of this index.
     */
    VANTAGE_STATUS_UNKNOWN_CANDIDATE = 15,
    /*
     There is no room for so many candidates.
     */
    VANTAGE_STATUS_TOO_MANY_CANDIDATES = 16,
    /*
     There is no room for so many views.
     */
    VANTAGE_STATUS_TOO_MANY_VIEWS = 17,
    /*
     The buffer is too small for the snapshot.
     */
    VANTAGE_STATUS_NO_ROOM = 18,
    /*
     The bytes are no snapshot, or a damaged one.
     */
    VANTAGE_STATUS_BAD_SNAPSHOT = 19,
    /*
     The snapshot was written in another version.
     */
    VANTAGE_STATUS_OTHER_SNAPSHOT_VERSION = 20,
    /*
     The snapshot is of a session with another model.
     */
    VANTAGE_STATUS_OTHER_MODEL = 21,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum vantage_status vantage_status;
#else
typedef uint32_t vantage_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 Why a view was chosen.
 */
enum vantage_reason
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     One of the first views.
     */
    VANTAGE_REASON_START = 0,
    /*
     By chance.
     */
    VANTAGE_REASON_CHANCE = 1,
    /*
     Farthest from all views so far.
     */
    VANTAGE_REASON_FARTHEST = 2,
    /*
     Most new surface expected.
     */
    VANTAGE_REASON_COVERAGE = 3,
    /*
     Most fine shape left to see.
     */
    VANTAGE_REASON_GEOMETRY = 4,
    /*
     Most new viewing directions.
     */
    VANTAGE_REASON_DIVERSITY = 5,
    /*
     Most surface detail left to see.
     */
    VANTAGE_REASON_TEXTURE = 6,
    /*
     Most gain over all four objectives.
     */
    VANTAGE_REASON_ALL_OBJECTIVES = 7,
    /*
     Most support for what later views will look for; no scheme of this header asks for it.
     */
    VANTAGE_REASON_SUPPORT = 8,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum vantage_reason vantage_reason;
#else
typedef uint32_t vantage_reason;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 Why there is no next view.
 */
enum vantage_finish_reason
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     There is one.
     */
    VANTAGE_FINISH_REASON_NOT_YET = 0,
    /*
     As many views as asked for have been taken.
     */
    VANTAGE_FINISH_REASON_BUDGET_SPENT = 1,
    /*
     The stop rule: further views promise too little.
     */
    VANTAGE_FINISH_REASON_GOOD_ENOUGH = 2,
    /*
     Every candidate has been visited, blocked or skipped.
     */
    VANTAGE_FINISH_REASON_NOTHING_LEFT = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum vantage_finish_reason vantage_finish_reason;
#else
typedef uint32_t vantage_finish_reason;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 What has become of a candidate.
 */
enum vantage_candidate_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     It may be chosen.
     */
    VANTAGE_CANDIDATE_STATUS_AVAILABLE = 0,
    /*
     A photo was taken of it.
     */
    VANTAGE_CANDIDATE_STATUS_VISITED = 1,
    /*
     Not before another photo has been taken.
     */
    VANTAGE_CANDIDATE_STATUS_SKIPPED = 2,
    /*
     It cannot be reached.
     */
    VANTAGE_CANDIDATE_STATUS_BLOCKED = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum vantage_candidate_status vantage_candidate_status;
#else
typedef uint32_t vantage_candidate_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 How views are chosen: `scheme` of a plan.
 */
enum vantage_scheme
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     One objective a view, C Q Q D D T in turn: the paper's.
     */
    VANTAGE_SCHEME_ENSEMBLE = 0,
    /*
     The largest sum of the four gains.
     */
    VANTAGE_SCHEME_SUM = 1,
    /*
     Most new surface.
     */
    VANTAGE_SCHEME_COVERAGE = 2,
    /*
     Most fine shape.
     */
    VANTAGE_SCHEME_GEOMETRY = 3,
    /*
     Most new directions.
     */
    VANTAGE_SCHEME_DIVERSITY = 4,
    /*
     Most fine texture.
     */
    VANTAGE_SCHEME_TEXTURE = 5,
    /*
     Farthest from all views so far; looks at no photo.
     */
    VANTAGE_SCHEME_FARTHEST_POINT = 6,
    /*
     By chance; looks at no photo.
     */
    VANTAGE_SCHEME_RANDOM = 7,
    /*
     Most support for later views, well away from all views so far and, for six views, from their
     opposite sides. Needs a model that looks at photos.
     */
    VANTAGE_SCHEME_SUPPORT = 8,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum vantage_scheme vantage_scheme;
#else
typedef uint32_t vantage_scheme;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 How pixels lie in memory: `format` of a photo.
 */
enum vantage_format
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     Two bytes, a little-endian number: 5 bits red (highest), 6 green, 5 blue.
     */
    VANTAGE_FORMAT_RGB565 = 0,
    /*
     Three bytes: red, green, blue.
     */
    VANTAGE_FORMAT_RGB888 = 1,
    /*
     One byte of brightness.
     */
    VANTAGE_FORMAT_LUMA8 = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum vantage_format vantage_format;
#else
typedef uint32_t vantage_format;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 From where a camera may look at the object: `space` of a pool.
 */
enum vantage_space
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     Drawn evenly from the whole sphere by `seed`.
     */
    VANTAGE_SPACE_RANDOM_SPHERE = 0,
    /*
     An even lattice on the whole sphere.
     */
    VANTAGE_SPACE_FIBONACCI_SPHERE = 1,
    /*
     An even lattice between two elevations: what is above a table.
     */
    VANTAGE_SPACE_HEMISPHERE = 2,
    /*
     Level rings one above the other: a turntable.
     */
    VANTAGE_SPACE_RINGS = 3,
    /*
     One line that winds upwards.
     */
    VANTAGE_SPACE_SPIRAL = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum vantage_space vantage_space;
#else
typedef uint32_t vantage_space;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 A capture in progress, in the caller's memory.
 */
typedef struct vantage_session vantage_session;

/*
 A numbered set of candidates that look at one point. Fields that a space does not name are not read.
 */
typedef struct vantage_pool {
    /*
     A `vantage_space`.
     */
    uint32_t space;
    /*
     How many candidates.
     */
    uint32_t count;
    /*
     Their distance from the target, metres.
     */
    float radius_m;
    /*
     The point they look at, metres.
     */
    float target_m[3];
    /*
     Lowest elevation in radians: hemisphere, rings, spiral.
     */
    float min_elevation_rad;
    /*
     Highest elevation in radians: hemisphere, rings, spiral.
     */
    float max_elevation_rad;
    /*
     Number of rings: rings.
     */
    uint32_t rings;
    /*
     How often the line goes around: spiral.
     */
    float turns;
    /*
     The same seed gives the same candidates: random sphere.
     */
    uint64_t seed;
} vantage_pool;

/*
 Where a camera stands and looks: `world_from_camera`. The world is right-handed with +Z up; the
 camera looks along its -Z, +X right, +Y up (OpenGL's axes).
 */
typedef struct vantage_pose {
    /*
     Camera centre x, y, z in the world, metres.
     */
    float position_m[3];
    /*
     Unit quaternion x, y, z, w; off unit length by 1e-3 at most.
     */
    float rotation[4];
} vantage_pose;

/*
 What is asked of the planner.
 */
typedef struct vantage_plan {
    /*
     A `vantage_scheme`.
     */
    uint32_t scheme;
    /*
     Views asked for, from 1 to the number of candidates.
     */
    uint32_t budget_views;
    /*
     For what is left to chance: the first view, and the random scheme.
     */
    uint64_t seed;
    /*
     In [0, 1]: the share of a gain that half a turn around the centre costs.
     */
    float movement_cost;
    /*
     The stop rule: a choice of less expected gain is weak.
     */
    float stop_gain;
    /*
     So many weak choices in a row end the session; 0 for no stop rule.
     */
    uint32_t stop_patience;
    /*
     The object's middle in the world, metres.
     */
    float centre_m[3];
} vantage_plan;

/*
 The next view, and why.
 */
typedef struct vantage_next {
    /*
     Its index among the candidates.
     */
    uint32_t index;
    /*
     Where to stand.
     */
    struct vantage_pose pose;
    /*
     Why it was chosen.
     */
    vantage_reason reason;
    /*
     The gain expected of it, in the objective's own units; metres for farthest points.
     */
    float gain;
} vantage_next;

/*
 A photo in the caller's memory, row by row from the top, without gaps.
 */
typedef struct vantage_photo {
    /*
     The pixels.
     */
    const uint8_t *pixels;
    /*
     Bytes there are: width x height x bytes of a pixel.
     */
    size_t length;
    /*
     Width in pixels.
     */
    uint32_t width;
    /*
     Height in pixels.
     */
    uint32_t height;
    /*
     A `vantage_format`.
     */
    uint32_t format;
    /*
     The square to look at: its left edge in pixels; it may reach over the border.
     */
    int32_t window_left;
    /*
     Its upper edge.
     */
    int32_t window_top;
    /*
     Its side; 0 for the largest square in the middle.
     */
    uint32_t window_side;
} vantage_photo;

/*
 Scores of the views so far, in [0, 1], as the model sees them.
 */
typedef struct vantage_score_values {
    /*
     How much of the surface has been seen.
     */
    float coverage;
    /*
     How much fine shape has been seen, and how often.
     */
    float geometry;
    /*
     From how many directions it has been seen.
     */
    float diversity;
    /*
     How much fine texture has been seen, and how often.
     */
    float texture;
} vantage_score_values;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 The version of the interface that the library was built with; compare it with `VANTAGE_ABI`.
 */
uint32_t vantage_abi(void);

/*
 The library's version, such as "0.1.0".
 */
const char *vantage_version(void);

/*
 Writes the pose of candidate `index` of a pool.

 The caller promises:
 Both pointers are null or valid for one value.
 */
vantage_status vantage_pool_pose(const struct vantage_pool *pool,
                                 uint32_t index,
                                 struct vantage_pose *pose);

/*
 Writes the pose of a camera at `eye_m` that looks at `target_m` with the photo's top towards +Z, each
 three numbers in metres.

 The caller promises:
 The pointers are null or valid for three numbers, `pose` for one value.
 */
vantage_status vantage_pose_looking_at(const float *eye_m,
                                       const float *target_m,
                                       struct vantage_pose *pose);

/*
 Says whether bytes are a model that this library can use.

 The caller promises:
 `model` is null or valid for `model_length` bytes.
 */
vantage_status vantage_model_check(const uint8_t *model, size_t model_length);

/*
 The bytes that a session of so many candidates and views needs with a model; 0 where the model
 cannot be used. `VANTAGE_SESSION_SIZE` is never less for models of the default sizes.

 The caller promises:
 `model` is null or valid for `model_length` bytes.
 */
size_t vantage_session_size(const uint8_t *model,
                            size_t model_length,
                            uint32_t candidates,
                            uint32_t views);

/*
 What a session's memory must be aligned to: `VANTAGE_SESSION_ALIGN`.
 */
size_t vantage_session_align(void);

/*
 Makes a session in `memory` over `count` candidates, with room for `views` views, and writes where it
 is. The memory belongs to the session until the caller uses it for something else. The model may lie
 anywhere; aligned to 4 bytes it is read many times faster.

 The caller promises:
 `memory` is null or valid for `size` bytes that nobody else uses while the session is used. `model`
 is null or valid for `model_length` bytes that stay as they are just as long, such as in flash.
 `candidates` is null or valid for `count` poses; `plan` and `session` are null or valid for one value.
 */
vantage_status vantage_session_new(uint8_t *memory,
                                   size_t size,
                                   const uint8_t *model,
                                   size_t model_length,
                                   const struct vantage_pose *candidates,
                                   size_t count,
                                   const struct vantage_plan *plan,
                                   uint32_t views,
                                   struct vantage_session **session);

/*
 Makes a session in `memory` as it stood when a snapshot of it was written, with room for `views`
 views, and writes where it is.

 The caller promises:
 As of `vantage_session_new`; `snapshot` is null or valid for `length` bytes.
 */
vantage_status vantage_session_restore(uint8_t *memory,
                                       size_t size,
                                       const uint8_t *model,
                                       size_t model_length,
                                       const uint8_t *snapshot,
                                       size_t length,
                                       uint32_t views,
                                       struct vantage_session **session);

/*
 Writes the next view; `VANTAGE_STATUS_DONE` where there is none. Asking again gives the same view.

 The caller promises:
 `session` is null or a session that nobody else uses meanwhile; `next` is null or valid for one value.
 */
vantage_status vantage_next_view(struct vantage_session *session,
                                 struct vantage_next *next);

/*
 Takes in the photo of a candidate, at the pose that was really reached. Any candidate may be
 photographed, not only the one asked for. `photo` may be null for a model that looks at poses alone.

 The caller promises:
 `session` is null or a session that nobody else uses meanwhile; `reached` and `photo` are null or valid
 for one value, and the photo's `pixels` for `length` bytes.
 */
vantage_status vantage_observe(struct vantage_session *session,
                               uint32_t index,
                               const struct vantage_pose *reached,
                               const struct vantage_photo *photo);

/*
 Takes in a photo that was taken anywhere, for no candidate.

 The caller promises:
 As of `vantage_observe`.
 */
vantage_status vantage_observe_elsewhere(struct vantage_session *session,
                                         const struct vantage_pose *reached,
                                         const struct vantage_photo *photo);

/*
 A candidate cannot be reached: it is not asked for again.

 The caller promises:
 `session` is null or a session that nobody else uses meanwhile.
 */
vantage_status vantage_block(struct vantage_session *session, uint32_t index);

/*
 A blocked or skipped candidate can be reached after all.

 The caller promises:
 `session` is null or a session that nobody else uses meanwhile.
 */
vantage_status vantage_unblock(struct vantage_session *session, uint32_t index);

/*
 Not this candidate now; perhaps after the next photo.

 The caller promises:
 `session` is null or a session that nobody else uses meanwhile.
 */
vantage_status vantage_skip(struct vantage_session *session, uint32_t index);

/*
 Goes on with another plan; photos, blocked candidates and scores stay. The model goes on with the
 centre that the session was made with.

 The caller promises:
 `session` is null or a session that nobody else uses meanwhile; `plan` is null or valid for one value.
 */
vantage_status vantage_replan(struct vantage_session *session,
                              const struct vantage_plan *plan);

/*
 Writes why there is no next view.

 The caller promises:
 `session` is null or a session that nobody else uses meanwhile; `finish` is null or valid for one
 value.
 */
vantage_status vantage_finish(struct vantage_session *session, vantage_finish_reason *finish);

/*
 Writes the scores of the photos so far, as the model sees them.

 The caller promises:
 `session` is null or a session that nobody else uses meanwhile; `scores` is null or valid for one
 value.
 */
vantage_status vantage_scores(struct vantage_session *session, struct vantage_score_values *scores);

/*
 Writes how many photos have been taken in.

 The caller promises:
 `session` is null or a session that nobody else uses meanwhile; `count` is null or valid for one
 number.
 */
vantage_status vantage_view_count(struct vantage_session *session, uint32_t *count);

/*
 Writes what has become of a candidate.

 The caller promises:
 `session` is null or a session that nobody else uses meanwhile; `status` is null or valid for one
 value.
 */
vantage_status vantage_candidate(struct vantage_session *session,
                                 uint32_t index,
                                 vantage_candidate_status *status);

/*
 Writes the session as bytes, to go on after a power loss, and how many they are.

 The caller promises:
 `session` is null or a session that nobody else uses meanwhile; `buffer` is null or valid for `size`
 bytes, `length` for one number.
 */
vantage_status vantage_snapshot(struct vantage_session *session,
                                uint8_t *buffer,
                                size_t size,
                                size_t *length);

/*
 One sentence for a status; never null, also for numbers that are none.
 */
const char *vantage_status_text(uint32_t status);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* VANTAGE_H */
