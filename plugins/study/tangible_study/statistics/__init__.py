"""Statistics of studies: intervals, sensitivity, scales of paired comparisons, psychometric functions."""
