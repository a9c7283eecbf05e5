/* sort.c - see sort.h */
#include "life/sort.h"

enum { SHORT = 16 };

static void insert_all(double *v, int low, int high)
{
	for (int i = low + 1; i <= high; i++) {
		double x = v[i];
		int k = i;

		for (; k > low && v[k - 1] > x; k--)
			v[k] = v[k - 1];
		v[k] = x;
	}
}

static double middle_of_three(double a, double b, double c)
{
	double low = a < b ? a : b, high = a < b ? b : a;

	return c < low ? low : c > high ? high : c;
}

/* Hoare's partition, then the same for the sides that hold ranks.  The side on the right
 * is taken in place, so that the depth is that of the left turns alone. */
static void sort_between(double *v, int low, int high, const int *rank, int count)
{
	while (count > 0 && high - low >= SHORT) {
		double pivot =
			middle_of_three(v[low], v[low + (high - low) / 2], v[high]);
		int i = low, j = high, left = 0;

		while (i <= j) {
			while (v[i] < pivot)
				i++;
			while (v[j] > pivot)
				j--;
			if (i <= j) {
				double x = v[i];

				v[i++] = v[j];
				v[j--] = x;
			}
		}
		while (left < count && rank[left] <= j)
			left++;
		sort_between(v, low, j, rank, left);
		while (left < count && rank[left] < i) /* it equals the pivot */
			left++;
		rank += left;
		count -= left;
		low = i;
	}
	if (count > 0)
		insert_all(v, low, high);
}

void sort_at(double *v, int n, const int *rank, int count)
{
	sort_between(v, 0, n - 1, rank, count);
}
