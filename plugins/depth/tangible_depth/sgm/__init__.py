"""Semi-global matching: census codes, matching costs, paths, and their aggregation in strips."""
