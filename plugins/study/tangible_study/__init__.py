"""Studies: experiments with people from one file, on any device, with every answer kept."""
