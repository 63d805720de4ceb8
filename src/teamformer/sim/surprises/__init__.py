"""What nobody knew: what tasks need, how long they last, where they are, who stands still."""
