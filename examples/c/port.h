/* What main.c needs of the machine: where text goes, and the bytes that lie in flash (data.S). */

#ifndef PORT_H
#define PORT_H

#include <stddef.h>
#include <stdint.h>

/* Writes a text. */
void port_put(const char *text);

struct port_recording {
    const char *name;
    const uint8_t *bytes;
    size_t length;
};

extern const uint8_t port_model[];
extern const size_t port_model_length;
extern const struct port_recording port_recordings[];
extern const size_t port_recording_count;

#endif
