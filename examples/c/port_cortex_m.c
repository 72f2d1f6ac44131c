/* On a Cortex-M with a debugger, such as QEMU's mps2-an386: text and exit code over semihosting. */

#include "port.h"

int main(void);
void reset(void);

/* From cortex_m.ld. */
extern uint32_t stack_top[], data_start[], data_end[], data_stored[], bss_start[], bss_end[];

/* Asks the debugger for a service; the argument is a number or the address of several. */
static uint32_t semihosting(uint32_t service, uintptr_t argument)
{
    register uint32_t r0 __asm__("r0") = service;
    register uintptr_t r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void leave(int code)
{
    semihosting(0x18 /* SYS_EXIT */, code == 0 ? 0x20026 : 0x20023);
    for (;;) {
    }
}

void port_put(const char *text)
{
    static uint32_t standard_output; /* its handle; 0 before it is opened */
    if (standard_output == 0) {
        const uintptr_t open[] = { (uintptr_t) ":tt", 4 /* "w" */, 3 };
        standard_output = semihosting(0x01 /* SYS_OPEN */, (uintptr_t)open);
    }
    uintptr_t length = 0;
    while (text[length] != '\0') {
        length++;
    }
    const uintptr_t write[] = { standard_output, (uintptr_t)text, length };
    semihosting(0x05 /* SYS_WRITE */, (uintptr_t)write);
}

/* A fault would hang; it must fail instead. */
static void fault(void)
{
    leave(1);
}

__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {
    (void (*)(void))(uintptr_t)stack_top, reset, fault, fault, fault, fault, fault, 0, 0, 0, 0,
    fault, fault, 0, fault, fault,
};

void reset(void)
{
    *(volatile uint32_t *)0xe000ed88 |= 0xfu << 20; /* CPACR: the floating-point unit is on */
    __asm__ volatile("dsb\n\tisb" ::: "memory");
    for (uint32_t *to = data_start, *from = data_stored; to < data_end;) {
        *to++ = *from++;
    }
    for (uint32_t *to = bss_start; to < bss_end;) {
        *to++ = 0;
    }
    leave(main());
}
