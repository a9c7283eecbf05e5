/* verdict.h - whether the model describes a section or a pulse */
#ifndef SIGNAL_VERDICT_H
#define SIGNAL_VERDICT_H

enum separate_verdict {
	SEPARATE_ALONE,      /* one pulse in its section */
	SEPARATE_OVERLAP,    /* several overlapping pulses, separated */
	SEPARATE_MISFIT,     /* chi-square too large: the model does not describe it */
	SEPARATE_UNRESOLVED, /* too dense: a row stands for sources particles or more */
	/* Events that are no particles, see foreign.h and spikes.h. */
	SEPARATE_SHOCK,
	SEPARATE_BUBBLE,
	SEPARATE_IMPULSE,
	SEPARATE_TRANSIENT,
	SEPARATE_VERDICTS
};

/* 1 if it is known what the event is, other than particles. */
static inline int verdict_is_foreign(enum separate_verdict verdict)
{
	return verdict > SEPARATE_UNRESOLVED;
}

#endif
