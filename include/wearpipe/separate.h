/* separate.h - wear particles in the record of two inductive sensors, found as by duet(1)
 *
 *	struct wp_separate_par par = { .rate = 10e3 };
 *	struct wp_separate *s = wp_separate_new(&par, NULL);
 *	static double x[2 * 4096];
 *	struct wp_transit p;
 *	for (int i = 0; i < 4096; i++) {
 *		x[2 * i] = sin(i * 0.7) + 20 * exp(-pow((i - 1000) / 20.0, 2));
 *		x[2 * i + 1] = cos(i * i * 0.3) + 20 * exp(-pow((i - 1196) / 20.0, 2));
 *	}
 *	if (!s || wp_separate_push(s, x, 4096) == WP_NO_MEMORY)
 *		return 1;
 *	wp_separate_end(s);
 *	while (wp_separate_next(s, &p))
 *		printf("%g s %g m\n", p.time1, p.diameter);
 *	wp_separate_free(s);
 */
#ifndef WEARPIPE_SEPARATE_H
#define WEARPIPE_SEPARATE_H

#include <stddef.h>
#include <wearpipe/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a row represents, and whether it is reliable. */
enum wp_verdict {
	WP_ALONE,      /* one pulse in its section */
	WP_OVERLAP,    /* one of several in its section, separated */
	WP_MISFIT,     /* not described by the pulse of a particle */
	WP_UNRESOLVED, /* the row stands for sources particles */
	/* No particle: */
	WP_SHOCK,    /* the same at both sensors at once */
	WP_BUBBLE,   /* a single lobe that passes with the oil */
	WP_IMPULSE,  /* a few samples */
	WP_TRANSIENT /* at one sensor only; the time at the other is NAN */
};

/* A particle; standard errors end in _se; NAN where a number is not known. */
struct wp_transit {
	double time1, time2; /* arrival at either sensor, s from the first frame */
	double diameter;     /* m */
	double amplitude;    /* at sensor 1, V */
	double delay;        /* from sensor to sensor, s */
	double velocity;     /* m/s */
	double time1_se, time2_se, diameter_se, amplitude_se, delay_se, velocity_se;
	double section;       /* number of its section of the record, from 1 */
	double sources;       /* particles in the section */
	double chi2;          /* of the section, per degree of freedom */
	int verdict;          /* enum wp_verdict */
	double diameter_most; /* m: upper limit of diameters in an unresolved section */
};

/* What is known of the record; 0 where it is to be learned from it or is as in duet(1).
 */
struct wp_separate_par {
	double rate;           /* frames per second, Hz; must be given */
	double delay;          /* from sensor to sensor of the mean particle, s */
	double pulse_duration; /* of the mean particle, s */
	double gain;           /* of sensor 2 over sensor 1 */
	double spacing;        /* of the sensors, m; 0: 0.25 */
	double calibration;    /* voltage over velocity and diameter cubed, V s/m4 */
	double false_alarm;    /* false particles per sample of noise; 0: 1e-9 */
	double learn;          /* start of the record to learn from, s; 0: 65536 frames */
};

struct wp_separate;
WP_API struct wp_separate *wp_separate_new(
	const struct wp_separate_par *par, enum wp_status *status);
WP_API void wp_separate_free(struct wp_separate *s);

/* frames of two channels, x[2 * frame + channel], V.  WP_IMPOSSIBLE where nothing can be
 * learned from the record; see wp_separate_reason(). */
WP_API enum wp_status wp_separate_push(
	struct wp_separate *s, const double *x, size_t frames);
/* The rest of the particles.  WP_NOT_CONVERGED where they are doubtful, or where the
 * channels have nothing in common and there are none. */
WP_API enum wp_status wp_separate_end(struct wp_separate *s);
/* The next particle, by section and arrival; 0 where none is ready. */
WP_API int wp_separate_next(struct wp_separate *s, struct wp_transit *p);
/* Why the last call of push or end did not return WP_OK, in words; never NULL. */
WP_API const char *wp_separate_reason(const struct wp_separate *s);

#ifdef __cplusplus
}
#endif
#endif
