/* On a computer: text to standard output. */

#include <stdio.h>

#include "port.h"

void port_put(const char *text)
{
    fputs(text, stdout);
}
