/* roughness_options.h - how rough a surface shall be: options of roughgen for generated
 * and measured ones alike */
#ifndef ROUGHNESS_OPTIONS_H
#define ROUGHNESS_OPTIONS_H

#include "cli/opt.h"
#include "surface/rough.h"

extern struct opt roughness_rows[]; /* for OPT_TABLE */

enum { POINTS_MAX = 65536 }; /* of a surface, along one direction */

/* Dies where a range runs backwards. */
void roughness_check(void);
/* The same for a range Q:Q2 of any option. */
void roughness_check_range(const char *word, const struct opt_list *range);

/* Of one value or two; 0 of none. */
struct rough_range roughness_range(const struct opt_list *range);

/* What is wanted; ROUGH_SQ of 1 um where nothing else was given. */
enum rough_kind roughness_kind(void);
struct rough_range roughness_target(void);

#endif
