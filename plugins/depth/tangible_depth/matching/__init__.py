"""The chain of a whole matcher, from views to a disparity map, dense or feature by feature: start at `chain`."""
