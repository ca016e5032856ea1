"""Semi-global matching: census codes, what matches cost, paths, and their aggregation in strips."""
