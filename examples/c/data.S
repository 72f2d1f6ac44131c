/* The model and the recordings, as they are, in flash. Paths begin at the repository's root. */

#if __SIZEOF_POINTER__ == 8
#define WORD .quad
#else
#define WORD .long
#endif

    .section .rodata
    .balign 16
    .global port_model
port_model:
    .incbin "lab/models/soarnet.model"
model_end:
    .balign 16
chair:
    .incbin "tests/sessions/golden/chair.recording"
chair_end:
    .balign 16
vase:
    .incbin "tests/sessions/golden/vase.recording"
vase_end:
chair_name:
    .asciz "chair"
vase_name:
    .asciz "vase"

/* Addresses: where the program may be loaded anywhere, the loader writes them first. */
    .section .data.rel.ro, "aw"
    .balign 8
    .global port_model_length
port_model_length:
    WORD model_end - port_model
    .global port_recording_count
port_recording_count:
    WORD 2
    .global port_recordings
port_recordings:
    WORD chair_name
    WORD chair
    WORD chair_end - chair
    WORD vase_name
    WORD vase
    WORD vase_end - vase

/* The stack need not be executable. */
    .section .note.GNU-stack, "", %progbits
