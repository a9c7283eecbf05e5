#include "cli/escape.h"
#include <stdio.h>

void escape_to(char *to, const char *s)
{
	for (; *s; s++) {
		unsigned char c = (unsigned char)*s, next = (unsigned char)s[1];

		if (c == '\n' || c == '\t' || c == '\r') {
			*to++ = '\\';
			*to++ = c == '\n' ? 'n' : c == '\t' ? 't' : 'r';
		} else if (c < 32 || c == 127) {
			to += sprintf(to, "\\x%02x", c);
		} else if (c == 0xc2 && next >= 0x80 && next < 0xa0) {
			to += sprintf(to, "\\x%02x", next); /* U+0080 to U+009f */
			s++;
		} else {
			*to++ = (char)c;
		}
	}
	*to = '\0';
}
