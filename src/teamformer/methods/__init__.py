"""What turns views into decisions, behind one seam."""
